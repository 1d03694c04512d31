#include "vesalius/detect_stream.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "stream/test_crossing.h"
#include "vesalius/base/test_threads.h"
#include "vesalius/error.h"
#include "vesalius/forest/test_blind_labeller.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

enum class Kind { files, camera, stalling_camera };

/// Gives numbered frames as fast as it can. One that stalls then waits until it is told to stop.
class Counter final : public FrameSource {
 public:
  Counter(int frames, Kind kind) : frames_(frames), kind_(kind) {}
  std::optional<Frame> next() override {
    std::unique_lock lock(mutex_);
    if (given_ == frames_) {
      asked_for_more_ = true;
      changed_.notify_all();
      if (kind_ == Kind::stalling_camera) changed_.wait(lock, [&] { return stopped_; });
      return std::nullopt;
    }
    Frame frame;
    frame.name = std::to_string(given_++);
    return frame;
  }
  int size() const override { return is_live() ? -1 : frames_; }
  bool is_live() const override { return kind_ != Kind::files; }
  void stop() override {
    const std::scoped_lock lock(mutex_);
    stopped_ = true;
    changed_.notify_all();
  }
  /// Waits until all frames were given and whoever got the last one asks for more.
  void wait_until_all_are_given() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return asked_for_more_; });
  }

 private:
  const int frames_;
  const Kind kind_;
  std::mutex mutex_;
  std::condition_variable changed_;
  int given_ = 0;
  bool asked_for_more_ = false;
  bool stopped_ = false;
};

constexpr int kFrames = 50;
constexpr std::size_t kAhead = 5;

// Labels: threads
TEST(PassedFramesThreads, OfALiveSourceAreDroppedAndCountedWhereTheDiskPauses) {
  Counter camera(kFrames, Kind::camera);
  int written = 0;
  const int dropped = stream_frames(camera, {}, kAhead, [&](const FoundFrame& found) {
    if (written == 0) {
      EXPECT_EQ(found.frame->name, "0");
      camera.wait_until_all_are_given();  // the pause
    }
    ++written;
    return true;
  });
  // One was being written while the others waited, unless all were given before it left the queue.
  EXPECT_GE(written, static_cast<int>(kAhead));
  EXPECT_LE(written, 1 + static_cast<int>(kAhead));
  EXPECT_EQ(dropped, kFrames - written);
}

// Labels: threads
TEST(PassedFramesThreads, OfFilesAreNeverDropped) {
  Counter files(kFrames, Kind::files);
  int written = 0;
  const int dropped = stream_frames(files, {}, kAhead, [&](const FoundFrame& found) {
    if (written == 0) std::this_thread::sleep_for(std::chrono::milliseconds(50));  // the pause
    EXPECT_EQ(found.frame->name, std::to_string(written++));
    return true;
  });
  EXPECT_EQ(written, kFrames);
  EXPECT_EQ(dropped, 0);
}

// Labels: threads
TEST(PassedFramesThreads, EndWhenEnoughAreTakenAndTheCameraGivesNoMore) {
  Counter camera(3, Kind::stalling_camera);
  int written = 0;
  stream_frames(camera, {}, kAhead, [&](const FoundFrame&) { return ++written < 3; });
  EXPECT_EQ(written, 3);
  EXPECT_FALSE(camera.next()) << "it was stopped";
}

// Labels: threads
TEST(PassedFramesThreads, PassOnWhatTheWriterThrows) {
  Counter files(kFrames, Kind::files);
  EXPECT_THROW(stream_frames(files, {}, kAhead, [](const FoundFrame&) -> bool { throw Error("the disk is full"); }),
               Error);
}

/// A labeller that finds nobody, and takes its time for it.
class Slow : public test::BlindLabeller {
 public:
  void label_into(const Frame& frame, float gate, Posteriors& out) const override {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    test::BlindLabeller::label_into(frame, gate, out);
  }
};

/// A camera that is lost after its first frame and at once back.
class Unsteady : public FrameSource {
 public:
  std::optional<Frame> next() override {
    if (++asked_ == 2) throw Error("unplugged");
    if (asked_ > 50) return std::nullopt;
    return Frame{"", {}, {80, 60, 65.F, 65.F, 39.5F, 29.5F}, DepthImage(80, 60, 3000), {}};
  }
  int size() const override { return -1; }
  bool is_live() const override { return true; }

 private:
  int asked_ = 0;
};

TEST(DetectedFrames, EndWithTheErrorOfACameraHoweverSlowTheDetectorIs) {
  Unsteady camera;
  std::vector<bool> failed;
  stream_frames(camera, Detector(std::make_shared<Slow>()), {}, [&](const FoundFrame& found) {
    failed.push_back(found.error != nullptr);
    return true;
  });
  ASSERT_FALSE(failed.empty());
  EXPECT_TRUE(failed.back());
  EXPECT_EQ(std::count(failed.begin(), failed.end(), true), 1);
}

std::string told(const FoundFrame& found) {
  std::string text = found.frame->name;
  if (found.error) return text + " failed";
  for (const TrackedPerson& person : found.people.people) {
    text += " " + std::to_string(person.id) + to_string(person.state) + std::to_string(person.person.score);
    for (const float x : person.position) text += "," + std::to_string(x);
  }
  return text;
}

std::vector<std::string> follow(test::Crossing& source, int fails_at = -1) {
  source.begin_again();
  const Detector detector(std::make_shared<test::Knowing>(source.frames(), fails_at));
  PeopleTracker tracker(detector.body(), {}, detector.appearance());
  std::vector<std::string> lines;
  stream_frames(source, detector, tracker, {}, [&](const FoundFrame& found) {
    lines.push_back(told(found));
    return true;
  });
  return lines;
}

// Labels: threads
TEST(FollowedFramesThreads, HaveTheSameIdsForAnyNumberOfThreads) {
  test::Crossing source;
  std::vector<std::vector<std::string>> all;
  for_threads({1, 2, 4}, [&] { all.push_back(follow(source)); });
  ASSERT_EQ(all[0].size(), static_cast<std::size_t>(test::Crossing::kLength));
  EXPECT_EQ(all[1], all[0]);
  EXPECT_EQ(all[2], all[0]);
  EXPECT_THAT(all[0].back(), testing::AllOf(testing::HasSubstr(" 1tracked"), testing::HasSubstr(" 2tracked"),
                                            testing::Not(testing::HasSubstr(" 3"))));
}

// Labels: threads
TEST(FollowedFramesThreads, OneThatFailsLeavesTheOthersAsTheyAre) {
  test::Crossing source;
  std::vector<std::vector<std::string>> all;
  for_threads({1, 2}, [&] { all.push_back(follow(source, 5)); });
  ASSERT_EQ(all[0].size(), static_cast<std::size_t>(test::Crossing::kLength));
  EXPECT_EQ(all[0][5], "5 failed");
  EXPECT_THAT(all[0][6], testing::HasSubstr(" 1tracked"));
  EXPECT_EQ(all[1], all[0]);
}

// Labels: threads
TEST(FollowedFramesThreads, EndWheneverTheTakerHasEnough) {
  test::Crossing source;
  const ThreadLimit limit(2);
  for (int enough = 1; enough < 6; ++enough) {
    source.begin_again();
    const Detector detector(std::make_shared<test::Knowing>(source.frames(), 2));
    PeopleTracker tracker(detector.body(), {}, detector.appearance());
    int taken = 0;
    stream_frames(source, detector, tracker, {}, [&](const FoundFrame&) { return ++taken < enough; });
    EXPECT_EQ(taken, enough);
  }
}

/// Somebody who stands before a wall, and raises an arm in the last frame. Somebody else is there from the frame
/// `comes` on.
std::vector<LabelledFrame> standing(int frames, int comes = -1) {
  std::vector<LabelledFrame> all;
  for (int i = 0; i < frames; ++i) {
    CapsuleScene scene;
    scene.people.resize(comes >= 0 && i >= comes ? 2 : 1);
    scene.people[0].feet = {-0.6F + 0.01F * static_cast<float>(i), 0.9F, 2.8F};
    scene.people[0].pose.l_arm.raise = i + 1 == frames ? 1.5F : 0.1F;
    if (scene.people.size() > 1) scene.people[1].feet = {1.F, 0.9F, 2.8F};
    scene.floor_y_m = 0.9F;
    scene.wall_z_m = 4.F;
    LabelledFrame truth = render(scene, {320, 240, 262.5F, 262.5F, 159.5F, 119.5F}, paper_body());
    truth.frame.time_s = i / kUsualRate;
    all.push_back(std::move(truth));
  }
  return all;
}

/// Follows the people in frames and returns what was told of each, and how many pictures were looked at.
struct Followed {
  Followed(const std::vector<LabelledFrame>& frames, const TrackOptions& options) {
    const auto labeller = std::make_shared<test::Knowing>(frames);
    const Detector detector(labeller);
    PeopleTracker tracker(detector.body(), options, detector.appearance());
    for (const LabelledFrame& truth : frames) {
      told.push_back(follow(detector, tracker, truth.frame).people);
      wholes.push_back(labeller->wholes);
      parts.push_back(labeller->parts);
    }
  }
  std::vector<std::vector<TrackedPerson>> told;
  std::vector<int> wholes, parts;  ///< up to each frame
};

TEST(FollowedFrames, AreLookedAtInPartsWithTheSamePeople) {
  const std::vector<LabelledFrame> frames = standing(20);
  TrackOptions always_whole;
  always_whole.whole_s = 0.F;
  const Followed parts(frames, {}), whole(frames, always_whole);
  EXPECT_EQ(whole.wholes.back(), 20);
  EXPECT_EQ(whole.parts.back(), 0);
  // Every sixth of 30 frames a second, and the last one, whose arm reaches out of the part.
  EXPECT_EQ(parts.wholes.back(), 5);
  EXPECT_EQ(parts.parts.back(), 16);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    ASSERT_EQ(parts.told[i].size(), 1U);
    ASSERT_EQ(whole.told[i].size(), 1U);
    const TrackedPerson &a = parts.told[i][0], &b = whole.told[i][0];
    EXPECT_EQ(a.id, b.id);
    EXPECT_LT((a.position - b.position).norm(), 0.02F);
    EXPECT_GT(shared_pixels(a.person.mask, b.person.mask), 0.95F) << "frame " << i;
  }
  EXPECT_EQ(parts.told[19][0].person.mask, whole.told[19][0].person.mask) << "with the hand";
}

TEST(FollowedFrames, ShowWhoeverComesInAtOnce) {
  const std::vector<LabelledFrame> frames = standing(9, 7);
  const Followed followed(frames, {});
  EXPECT_GT(followed.parts[6], followed.parts[0]);
  EXPECT_EQ(followed.told[6].size(), 1U);
  EXPECT_EQ(followed.told[7].size(), 2U);
}

/// Empty frames at these times.
class Times final : public FrameSource {
 public:
  explicit Times(std::vector<double> times_s) : times_s_(std::move(times_s)) {}
  std::optional<Frame> next() override {
    if (given_ == times_s_.size()) return std::nullopt;
    return Frame{"", times_s_[given_++], {80, 60, 65.F, 65.F, 39.5F, 29.5F}, DepthImage(80, 60, 3000), {}};
  }
  int size() const override { return int(times_s_.size()); }

 private:
  std::vector<double> times_s_;
  std::size_t given_ = 0;
};

// Labels: threads
TEST(RealTimeThreads, NeverWaitsForAClockThatJumps) {
  constexpr double kNow_s = 1.7e9;
  const auto start = std::chrono::steady_clock::now();
  // 1970, then now, a frame that comes late, nonsense, and the clock set back by years.
  Times source({0.0, 0.03, kNow_s, kNow_s + 0.06, kNow_s + 0.03, kNow_s + 0.09, std::nan(""), 1e300, 5.0, 5.03});
  const Detector detector(std::make_shared<test::BlindLabeller>());
  StreamOptions options;
  options.realtime = true;
  int taken = 0;
  const int dropped = stream_frames(source, detector, options, [&](const FoundFrame&) { return ++taken > 0; });
  EXPECT_EQ(taken + dropped, 10);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30)) << "two gaps of 2 s";
}

// Labels: threads
TEST(FollowedFramesThreads, InRealTimeHaveIdsToo) {
  test::Crossing source;
  const Detector detector(std::make_shared<test::Knowing>(source.frames()));
  PeopleTracker tracker(detector.body(), {}, detector.appearance());
  StreamOptions options;
  options.realtime = true;
  options.rate = 100.0;
  int taken = 0;
  const int dropped = stream_frames(source, detector, tracker, options, [&](const FoundFrame& found) {
    EXPECT_TRUE(found.people.followed) << found.frame->name;
    ++taken;
    return true;
  });
  EXPECT_EQ(taken + dropped, test::Crossing::kLength);
}

}  // namespace
}  // namespace vesalius
