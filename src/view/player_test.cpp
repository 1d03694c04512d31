#include "view/player.h"

#include <gmock/gmock.h>

#include <atomic>

#include "vesalius/base/error.h"

namespace vesalius {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using testing::ElementsAre;

/// Frames named 0, 1, 2, ... at `period_s`, some of which cannot be read.
class Numbers : public FrameSource {
 public:
  Numbers(int count, double period_s, bool timed = true) : count_(count), period_s_(period_s), timed_(timed) {}

  std::optional<Frame> next() override {
    if (at_ >= count_) return std::nullopt;
    const int number = at_++;
    if (number == bad) throw Error("bad frame");
    Frame frame;
    frame.name = std::to_string(number);
    if (timed_) frame.time_s = 100.0 + number * period_s_;
    return frame;
  }
  int size() const override { return count_; }
  std::optional<TimeSpan> span() const override {
    if (!can_seek) return std::nullopt;
    return TimeSpan{time_of(0), time_of(count_ - 1)};
  }
  void seek(double time_s) override {
    at_ = 0;
    while (at_ < count_ && time_of(at_) < time_s - 1e-9) ++at_;
  }
  bool is_live() const override { return live; }

  int bad = -1;
  bool can_seek = true;
  bool live = false;

 private:
  double time_of(int i) const { return timed_ ? 100.0 + i * period_s_ : i / kUsualRate; }

  int at_ = 0;
  int count_;
  double period_s_;
  bool timed_;
};

/// A player and what it showed.
class Shown {
 public:
  Shown(FrameSource& source, bool playing, double rate = 30.0)
      : player(source, rate, playing,
               {[this](PlayedFrame played) {
                  const std::scoped_lock lock(mutex_);
                  names_.push_back(played.frame.name);
                  times_.push_back(Clock::now());
                },
                [this](const std::string& why) {
                  const std::scoped_lock lock(mutex_);
                  names_.push_back(why);
                },
                [] {}}) {
    player.start();
  }
  ~Shown() { player.stop(); }

  /// Waits until `count` frames were shown and returns their names.
  std::vector<std::string> names(std::size_t count) {
    const auto patience = Clock::now() + 10s;
    for (;;) {
      {
        const std::scoped_lock lock(mutex_);
        if (names_.size() >= count || Clock::now() > patience) return names_;
      }
      std::this_thread::sleep_for(1ms);
    }
  }
  Clock::duration between(std::size_t a, std::size_t b) {
    const std::scoped_lock lock(mutex_);
    return times_.at(b) - times_.at(a);
  }
  /// Waits until the state is as wanted.
  bool reaches(const std::function<bool(const PlayerState&)>& wanted) {
    for (const auto patience = Clock::now() + 10s; Clock::now() < patience; std::this_thread::sleep_for(1ms)) {
      if (wanted(player.state())) return true;
    }
    return false;
  }

 private:
  std::mutex mutex_;
  std::vector<std::string> names_;
  std::vector<Clock::time_point> times_;

 public:
  Player player;
};

TEST(Player, PlaysAtThePaceOfTheFrames) {
  Numbers source(6, 0.02);
  Shown shown(source, true);
  shown.player.set_repeat(false);
  EXPECT_THAT(shown.names(6), ElementsAre("0", "1", "2", "3", "4", "5"));
  EXPECT_GE(shown.between(0, 5), 99ms);
  EXPECT_TRUE(shown.reaches([](const PlayerState& s) { return s.at_end && !s.playing; }));
  EXPECT_DOUBLE_EQ(shown.player.state().at_s, 100.1);
}

TEST(Player, PlaysFramesWithoutTimesAtTheGivenRate) {
  Numbers source(4, 0.0, false);
  Shown shown(source, true, 100.0);
  shown.names(4);
  EXPECT_GE(shown.between(0, 3), 29ms);
  EXPECT_LT(shown.between(0, 3), 95ms) << "which would be 30 a second";
}

TEST(Player, PausedShowsTheFirstFrameAndSteps) {
  Numbers source(5, 10.0);
  Shown shown(source, false);
  shown.player.step(1);
  shown.player.step(1);
  shown.player.step(-1);
  shown.player.step(-1);
  shown.player.step(-1);  // there is none before the first
  shown.player.step(1);
  EXPECT_THAT(shown.names(6), ElementsAre("0", "1", "2", "1", "0", "1"));
  EXPECT_FALSE(shown.player.state().playing);
}

TEST(Player, StepsBackThroughFramesWithoutTimes) {
  Numbers source(50, 0.0, false);
  Shown shown(source, false);
  shown.player.seek(40 / kUsualRate);
  shown.player.step(-1);
  shown.player.step(-1);
  shown.player.step(1);
  shown.player.step(1);
  EXPECT_THAT(shown.names(6), ElementsAre("0", "40", "39", "38", "39", "40"));
}

TEST(Player, SeeksAndGoesOnAsBefore) {
  Numbers source(1000, 0.01);
  Shown shown(source, false);
  shown.player.seek(105.0);
  shown.player.seek(1e9);
  shown.player.seek(-5.0);
  EXPECT_THAT(shown.names(4), ElementsAre("0", "500", "999", "0"));
  EXPECT_FALSE(shown.player.state().playing);
  shown.player.play();
  EXPECT_TRUE(shown.reaches([](const PlayerState& s) { return s.playing; }));
  shown.player.seek(109.99);
  EXPECT_TRUE(shown.reaches([](const PlayerState& s) { return s.playing && s.at_s < 109.0; })) << "it repeats";
}

TEST(Player, RepeatsOrPlaysAgainFromTheBeginning) {
  Numbers source(2, 0.001);
  Shown shown(source, true);
  const std::vector<std::string> names = shown.names(6);
  EXPECT_EQ(std::vector(names.begin(), names.begin() + 6), (std::vector<std::string>{"0", "1", "0", "1", "0", "1"}));
  shown.player.set_repeat(false);
  ASSERT_TRUE(shown.reaches([](const PlayerState& s) { return s.at_end; }));
  const std::size_t before = shown.names(0).size();
  shown.player.play();
  EXPECT_EQ(shown.names(before + 1).at(before), "0");
}

TEST(Player, WithoutSeekingPlaysOnce) {
  Numbers source(2, 0.001);
  source.can_seek = false;
  Shown shown(source, true);
  EXPECT_TRUE(shown.reaches([](const PlayerState& s) { return s.at_end; }));
  shown.player.seek(100.0);
  shown.player.step(-1);
  shown.player.play();
  std::this_thread::sleep_for(20ms);
  EXPECT_THAT(shown.names(2), ElementsAre("0", "1"));
}

TEST(Player, TellsOfFramesThatCannotBeReadAndGoesOn) {
  Numbers source(3, 0.001);
  source.bad = 1;
  Shown shown(source, true);
  shown.player.set_repeat(false);
  EXPECT_TRUE(shown.reaches([](const PlayerState& s) { return s.at_end; }));
  EXPECT_THAT(shown.names(3), ElementsAre("0", "bad frame", "2"));
}

TEST(Player, DoesNotWaitForALongGap) {
  Numbers source(2, 3600.0);
  Shown shown(source, true);
  EXPECT_GE(shown.names(2).size(), 2U);
  EXPECT_LT(shown.between(0, 1), 5s);
}

TEST(Player, TakesACamerasFramesAsTheyComeAndDropsThemWhilePaused) {
  Numbers source(1 << 20, 3600.0);
  source.live = true;
  source.can_seek = false;
  Shown shown(source, true);
  shown.names(100);
  shown.player.pause();
  ASSERT_TRUE(shown.reaches([](const PlayerState& s) { return !s.playing; }));
  const std::size_t before = shown.names(0).size();
  std::this_thread::sleep_for(20ms);
  EXPECT_EQ(shown.names(0).size(), before);
  shown.player.play();
  const int last = std::stoi(shown.names(before)[before - 1]);
  EXPECT_GT(std::stoi(shown.names(before + 1)[before]), last + 1) << "those in between were not kept";
}

}  // namespace
}  // namespace vesalius
