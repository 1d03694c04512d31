#include "view/player.h"

#include <gmock/gmock.h>

#include <atomic>

#include "vesalius/error.h"

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
    if (timed_) frame.time_s = time_of(number);
    return frame;
  }
  int size() const override { return count_; }
  std::optional<TimeSpan> span() const override {
    if (!can_seek) return std::nullopt;
    return TimeSpan{time_of(0), time_of(count_ - 1)};
  }
  void seek(double time_s) override {
    if (cannot_move) throw Error("no moving here");
    at_ = 0;
    while (at_ < count_ && time_of(at_) < time_s - 1e-9) ++at_;
  }
  bool is_live() const override { return live; }

  int bad = -1;
  bool can_seek = true;
  bool cannot_move = false;
  bool live = false;
  int gap_after = 1 << 30;  ///< frame after which nothing was taken for an hour
  double first_s = 100.0;

 private:
  double time_of(int i) const {
    return timed_ ? first_s + i * period_s_ + (i > gap_after ? 3600.0 : 0.0) : i / kUsualRate;
  }

  int at_ = 0;
  int count_;
  double period_s_;
  bool timed_;
};

/// A player and what it showed.
class Shown {
 public:
  Shown(FrameSource& source, const PlayerOptions& options)
      : player(source, options,
               {[this](PlayedFrame played) {
                  const std::scoped_lock lock(mutex_);
                  names_.push_back(played.frame.name);
                  times_.push_back(Clock::now());
                },
                [this](const std::string& why) {
                  const std::scoped_lock lock(mutex_);
                  names_.push_back(why);
                  times_.push_back(Clock::now());
                },
                [this](std::exception_ptr) { ++lost; }, [] {}}) {
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

  /// Waits until the frame of that name was shown; returns the frames so far.
  std::vector<std::string> names_up_to(const std::string& name) {
    for (std::size_t count = 1;; ++count) {
      std::vector<std::string> all = names(count);
      if (all.size() < count || all[count - 1] == name)
        return {all.begin(), all.begin() + static_cast<long>(std::min(count, all.size()))};
    }
  }

  std::atomic<int> lost = 0;

 private:
  std::mutex mutex_;
  std::vector<std::string> names_;
  std::vector<Clock::time_point> times_;

 public:
  Player player;
};

constexpr PlayerOptions kOnce{.repeat = false};
constexpr PlayerOptions kPaused{.playing = false};

TEST(Player, PlaysAtThePaceOfTheFrames) {
  Numbers source(6, 0.02);
  Shown shown(source, kOnce);
  EXPECT_THAT(shown.names(6), ElementsAre("0", "1", "2", "3", "4", "5"));
  EXPECT_GE(shown.between(0, 5), 99ms);
  EXPECT_TRUE(shown.reaches([](const PlayerState& s) { return s.at_end && !s.playing; }));
  EXPECT_DOUBLE_EQ(shown.player.state().at_s, 100.1);
}

TEST(Player, PlaysFramesWithoutTimesAtTheGivenRate) {
  Numbers source(4, 0.0, false);
  Shown shown(source, {.rate = 300.0, .repeat = false});
  shown.names(4);
  EXPECT_GE(shown.between(0, 3), 9ms);
  EXPECT_LT(shown.between(0, 3), 95ms) << "which would be 30 a second";
}

TEST(Player, SpeedCountsHoweverSlowTheSourceIs) {
  Numbers source(100, 0.0, false);
  Shown shown(source, {.rate = 0.2});
  shown.player.set_speed(0.1);
  shown.names(1);
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(shown.names(0).size(), 1U) << "50 s a frame";
  shown.player.set_speed(10);
  EXPECT_GE(shown.names(2).size(), 2U) << "half a second a frame";
}

TEST(Player, BearsTimesSinceTheEpoch) {
  Numbers source(5, 0.01);
  source.first_s = 1.7e9;
  Shown shown(source, kPaused);
  shown.player.seek(1.7e9 + 0.03);
  shown.player.step(-1);
  EXPECT_THAT(shown.names(3), ElementsAre("0", "3", "2"));
}

TEST(Player, PausedShowsTheFirstFrameAndSteps) {
  Numbers source(5, 10.0);
  Shown shown(source, kPaused);
  std::size_t count = 1;
  EXPECT_EQ(shown.names(1).size(), count);
  for (const int by : {1, 1, -1, -1}) {
    shown.player.step(by);
    shown.names(++count);
  }
  shown.player.step(-1);  // there is none before the first
  shown.player.step(1);
  EXPECT_THAT(shown.names(6), ElementsAre("0", "1", "2", "1", "0", "1"));
  EXPECT_FALSE(shown.player.state().playing);
}

TEST(Player, StepsBackThroughFramesWithoutTimes) {
  Numbers source(50, 0.0, false);
  Shown shown(source, kPaused);
  shown.player.seek(40 / kUsualRate);
  std::size_t count = 2;
  shown.names(count);
  for (const int by : {-1, -1, 1, 1}) {
    shown.player.step(by);
    shown.names(++count);
  }
  EXPECT_THAT(shown.names(6), ElementsAre("0", "40", "39", "38", "39", "40"));
}

TEST(Player, StepsBackAcrossAnHourWithoutFrames) {
  Numbers source(6, 0.1);
  source.gap_after = 2;
  Shown shown(source, kPaused);
  shown.player.seek(100.3 + 3600.0);
  shown.names(2);
  shown.player.step(-1);
  EXPECT_THAT(shown.names(3), ElementsAre("0", "3", "2"));
}

TEST(Player, SeeksAndGoesOnAsBefore) {
  Numbers source(1000, 0.01);
  Shown shown(source, kPaused);
  std::size_t count = 1;
  shown.names(count);
  for (const double to_s : {105.0, 1e9, -5.0}) {
    shown.player.seek(to_s);
    shown.names(++count);
  }
  EXPECT_THAT(shown.names(4), ElementsAre("0", "500", "999", "0"));
  EXPECT_FALSE(shown.player.state().playing);
  shown.player.play();
  shown.player.seek(109.98);
  EXPECT_TRUE(shown.reaches([](const PlayerState& s) { return s.at_s >= 109.98; }));
  EXPECT_EQ(shown.names_up_to("999").back(), "999");
  EXPECT_TRUE(shown.reaches([](const PlayerState& s) { return s.playing && s.at_s < 109.0; })) << "it repeats";
}

TEST(Player, RepeatsWithTheLastFrameShownAsLongAsTheOthers) {
  Numbers source(2, 0.1);
  Shown shown(source, {});
  const std::vector<std::string> names = shown.names(5);
  EXPECT_EQ(std::vector(names.begin(), names.begin() + 5), (std::vector<std::string>{"0", "1", "0", "1", "0"}));
  EXPECT_GE(shown.between(0, 4), 250ms)
      << "400, less what a busy machine shows the first one late; 200 if the last took none";
}

TEST(Player, PlaysALoopAgainAndAgain) {
  Numbers source(8, 0.01);
  Shown shown(source, kPaused);
  shown.player.set_loop(TimeSpan{100.05, 100.03});  // ends in either order
  shown.player.seek(100.02);
  shown.player.play();
  EXPECT_THAT(shown.names(9), testing::Contains("5").Times(testing::Ge(2)));
  shown.player.pause();
  std::vector<std::string> names = shown.names(9);
  names.resize(9);
  EXPECT_THAT(names, ElementsAre("0", "2", "3", "4", "5", "3", "4", "5", "3"));
}

TEST(Player, ALoopOutlastsMoves) {
  Numbers source(8, 0.01);
  Shown shown(source, {.playing = false, .repeat = false});
  shown.player.set_loop(TimeSpan{100.02, 100.03});
  shown.player.seek(100.05);
  std::size_t count = 2;
  for (const int by : {-1, -1, -1, 1}) {  // whoever steps sees what is beyond it too
    shown.names(count++);
    shown.player.step(by);
  }
  EXPECT_THAT(shown.names(6), ElementsAre("0", "5", "4", "3", "2", "3"));
  shown.player.seek(100.06);
  shown.player.play();
  std::vector<std::string> names = shown.names(12);
  names.resize(12);
  EXPECT_THAT(std::vector<std::string>(names.begin() + 6, names.end()), ElementsAre("6", "7", "2", "3", "2", "3"));
  EXPECT_NEAR(shown.player.state().loop.value().first_s, 100.02, 1e-9);
  shown.player.set_loop({});
  while (!shown.player.state().at_end) std::this_thread::sleep_for(1ms);
  EXPECT_FALSE(shown.player.state().loop.has_value());
}

TEST(Player, ALoopWithoutAFrameStopsNothing) {
  Numbers source(4, 0.01);
  Shown shown(source, kPaused);
  shown.player.set_loop(TimeSpan{100.012, 100.018});
  shown.player.play();
  std::vector<std::string> names = shown.names(5);
  names.resize(5);
  EXPECT_THAT(names, ElementsAre("0", "1", "2", "3", "2")) << "what comes after it";
}

TEST(Player, WithoutSeekingThereIsNoLoop) {
  Numbers source(3, 0.001);
  source.can_seek = false;
  Shown shown(source, {});
  shown.player.set_loop(TimeSpan{100.0, 100.001});
  EXPECT_THAT(shown.names(3), ElementsAre("0", "1", "2"));
  EXPECT_FALSE(shown.player.state().loop.has_value());
}

TEST(Player, PlaysAgainFromTheBeginning) {
  Numbers source(2, 0.001);
  Shown shown(source, kOnce);
  ASSERT_TRUE(shown.reaches([](const PlayerState& s) { return s.at_end; }));
  shown.player.play();
  EXPECT_THAT(shown.names(4), ElementsAre("0", "1", "0", "1"));
}

TEST(Player, ShowsASingleFrameOnce) {
  Numbers source(1, 0.001);
  Shown shown(source, {});
  EXPECT_TRUE(shown.reaches([](const PlayerState& s) { return s.at_end; }));
  EXPECT_THAT(shown.names(1), ElementsAre("0"));
}

TEST(Player, HeldKeysDoNotPileUp) {
  Numbers source(100000, 0.01);
  Shown shown(source, kPaused);
  for (int i = 0; i < 10000; ++i) shown.player.step(1);
  shown.player.pause();
  shown.player.seek(100.0 + 99999 * 0.01);
  EXPECT_LT(shown.names_up_to("99999").size(), 5000U);
}

TEST(Player, EndsPlayingWhereTheSourceCannotMove) {
  Numbers source(5, 0.01);
  source.cannot_move = true;
  Shown shown(source, kPaused);
  shown.player.seek(100.02);
  EXPECT_THAT(shown.names(2), ElementsAre("0", "no moving here"));
  shown.player.step(1);
  EXPECT_THAT(shown.names(3), ElementsAre("0", "no moving here", "1"));
}

TEST(Player, WithoutSeekingPlaysOnce) {
  Numbers source(2, 0.001);
  source.can_seek = false;
  Shown shown(source, {});
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
  Shown shown(source, kOnce);
  EXPECT_TRUE(shown.reaches([](const PlayerState& s) { return s.at_end; }));
  EXPECT_THAT(shown.names(3), ElementsAre("0", "bad frame", "2"));
}

TEST(Player, WaitsNoHourForAGapAndGoesOnAtThePace) {
  Numbers source(5, 0.01);
  source.gap_after = 1;
  Shown shown(source, {.repeat = false});
  shown.player.set_speed(10);
  EXPECT_THAT(shown.names(5), ElementsAre("0", "1", "2", "3", "4"));
  EXPECT_LT(shown.between(1, 2), 2s) << "two seconds at ten times the speed";
  EXPECT_LT(shown.between(2, 4), 150ms);
}

TEST(Player, WaitsTwoSecondsAtMostHoweverSlowItPlays) {
  Numbers source(3, 0.01);
  source.gap_after = 1;
  Shown shown(source, {.repeat = false});
  shown.player.set_speed(0.1);
  EXPECT_THAT(shown.names(3), ElementsAre("0", "1", "2"));
  EXPECT_LT(shown.between(1, 2), 5s) << "not twenty";
}

TEST(Player, ACameraThatFailsIsLost) {
  Numbers source(10, 0.01);
  source.live = true;
  source.can_seek = false;
  source.bad = 3;
  Shown shown(source, {});
  EXPECT_TRUE(shown.reaches([](const PlayerState& s) { return s.at_end && !s.live; }));
  EXPECT_THAT(shown.names(3), ElementsAre("0", "1", "2"));
  EXPECT_EQ(shown.lost, 1);
}

TEST(Player, TakesACamerasFramesAsTheyComeAndDropsThemWhilePaused) {
  Numbers source(1 << 20, 3600.0);
  source.live = true;
  source.can_seek = false;
  Shown shown(source, {});
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
