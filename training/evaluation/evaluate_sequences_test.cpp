#include <gmock/gmock.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <string>

#include "evaluation/evaluate_set.h"
#include "evaluation/evaluation_json.h"
#include "evaluation/evaluation_report.h"
#include "vesalius/base/test_threads.h"
#include "vesalius/error.h"
#include "vesalius/fit/flesh_model.h"
#include "vesalius/forest/test_blind_labeller.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr int kSize = 24;
constexpr int kFrames = 40;

/// Returns where the only person of frame `i` has its joints: a point that moves to the right by 1 cm a frame.
Eigen::Vector3f place_of(int i) { return {0.01F * static_cast<float>(i), 0.F, 2.F}; }

/// Recordings of one person, who stands in the columns i / 4 to i / 4 + 9 of frame i; nothing else has a reading. The
/// frame's time is its place in its recording.
class Recordings : public TruthSource {
 public:
  explicit Recordings(int count, int damaged = -1) : count_(count), damaged_(damaged) {}

  std::optional<TrueFrame> next() override {
    if (next_ == count_ * kFrames) return std::nullopt;
    const int number = next_++;
    if (number == damaged_) throw Error("frame " + std::to_string(number) + ": damaged");
    const int i = number % kFrames;
    TrueFrame frame;
    frame.frame.name = std::to_string(number);
    frame.frame.time_s = i / 30.0;
    frame.frame.camera = {kSize, kSize, 20.F, 20.F, 11.5F, 11.5F};
    frame.frame.depth = DepthImage(kSize, kSize, 0);
    FrameTruth& truth = frame.truth;
    truth.people = 1;
    truth.person = Image<std::uint8_t>(kSize, kSize, kBackground);
    for (int v = 0; v < kSize; ++v) {
      std::fill_n(frame.frame.depth.row(v) + i / 4, 10, std::uint16_t{2000});
      std::fill_n(truth.person.row(v) + i / 4, 10, std::uint8_t{0});
    }
    truth.joint_names = {"l_hip", "r_hip"};
    truth.joints = {{place_of(i), place_of(i)}};
    truth.sequence = number / kFrames;
    truth.ids = {7};
    truth.posture = "standing";
    return frame;
  }
  int size() const override { return count_ * kFrames; }

 private:
  int count_;
  int damaged_;
  int next_ = 0;
};

/// Finds everything that has a reading, in turn 2 cm above and below its place; from frame 20 on it has another id.
class TestTracker {
 public:
  TrackedFrame operator()(const Frame& frame) {
    TrackedFrame tracked;
    tracked.time_s = *frame.time_s;
    TrackedPerson& person = tracked.people.emplace_back();
    person.id = frames_ < 20 ? 1 : 2;
    person.state = TrackState::tracked;
    person.stance = frames_ % 4 == 0 ? Stance::sitting : Stance::standing;
    person.person.skeleton.parts.resize(paper_body().parts.size());
    person.person.mask = Mask(kSize, kSize, 0);
    for (std::size_t i = 0; i < frame.depth.size(); ++i) person.person.mask[i] = frame.depth[i] != 0 ? 1 : 0;
    const Eigen::Vector3f up(0.F, frames_ % 2 == 0 ? 0.02F : -0.02F, 0.F);
    for (const JointSet& set : paper_body().joint_sets) {
      person.person.joints.emplace_back(set.joints.size(), Joint{State::observed, place_of(frames_) + up, 0.85F});
    }
    ++frames_;
    return tracked;
  }

 private:
  int frames_ = 0;
};

FrameScorer judge() { return FrameScorer(std::make_shared<test::BlindLabeller>(), {}); }

SetResult evaluate(int recordings, const SequenceTrackerFactory& trackers, int damaged = -1,
                   const SetOptions& options = {"clips", "memory"}, const EvaluationHooks& hooks = {}) {
  const OpenTruth open = [&] { return std::make_unique<Recordings>(recordings, damaged); };
  return evaluate_sequences(open, options, judge(), trackers, {}, hooks);
}

double value(const SetResult& set, Metric metric, const std::string& parameter = "") {
  const std::vector<Estimate> estimates = set.metrics.estimates();
  const Estimate* found = find_estimate(estimates, metric, parameter);
  return found != nullptr ? found->value : std::numeric_limits<double>::quiet_NaN();
}

TEST(EvaluateSequences, MeasuresTracksMotionAndSingleFrames) {
  const SetResult set = evaluate(3, [] { return TestTracker(); });
  EXPECT_EQ(set.frames, 3 * kFrames);
  EXPECT_DOUBLE_EQ(value(set, Metric::people_found), 1.0);
  EXPECT_DOUBLE_EQ(value(set, Metric::track_switches), 1.0);
  EXPECT_DOUBLE_EQ(value(set, Metric::track_ids), 2.0);
  EXPECT_DOUBLE_EQ(value(set, Metric::track_mota), 1.0 - 1.0 / kFrames);
  EXPECT_DOUBLE_EQ(value(set, Metric::track_idf1), 0.5);
  EXPECT_NEAR(value(set, Metric::joints_error), 0.02, 1e-5);
  EXPECT_NEAR(value(set, Metric::joints_jitter), 80.0 * 30 * 30, 10.0);
  EXPECT_NEAR(value(set, Metric::joints_true_jitter), 0.0, 1.0);
  EXPECT_DOUBLE_EQ(value(set, Metric::joints_right_confidence, "80_to_90"), 1.0);
  EXPECT_DOUBLE_EQ(value(set, Metric::stance_right), 0.75);
  EXPECT_DOUBLE_EQ(value(set, Metric::stance_given, "standing_as_sitting"), 0.25);
  EXPECT_THAT(summary_lines(set), ContainsRegex("\n  ids       IDF1 50.00 % .*, MOTA 97.50 %, ids 2.00 a person\n"));
}

TEST(EvaluateSequences, KnowsWhoHidesJointsAmongPeopleOfWhomSomeAreLost) {
  const SetResult set = evaluate(1, [] {
    return [tracker = TestTracker()](const Frame& f) mutable {
      TrackedFrame tracked = tracker(f);
      for (auto& joints : tracked.people[0].person.joints) {
        for (Joint& joint : joints) joint = {State::predicted, joint.position, 0.5F, Unseen::behind_person, 1};
      }
      TrackedPerson lost = tracked.people[0];
      lost.id = 99;
      lost.state = TrackState::lost;
      lost.person.mask = {};
      tracked.people.insert(tracked.people.begin(), lost);
      return tracked;
    };
  });
  EXPECT_DOUBLE_EQ(value(set, Metric::unseen_given, "not_sure_as_behind_itself"), 1.0);
  EXPECT_DOUBLE_EQ(value(set, Metric::unseen_right), 0.0);
}

TEST(EvaluateSequences, UsesSmoothedJointsWhereThereAreSome) {
  const SetResult set = evaluate(1, [] {
    return [tracker = TestTracker(), frame = 0](const Frame& f) mutable {
      TrackedFrame tracked = tracker(f);
      tracked.people[0].smoothed = tracked.people[0].person.joints;
      for (auto& joints : tracked.people[0].smoothed) {
        for (Joint& joint : joints) joint.position = place_of(frame);
      }
      ++frame;
      return tracked;
    };
  });
  EXPECT_NEAR(value(set, Metric::joints_error), 0.0, 1e-5);
}

// Labels: threads
TEST(EvaluateSequences, AreTheSameForAnyNumberOfThreads) {
  std::vector<std::string> reports;
  for (const int threads : {1, 4}) {
    const ThreadLimit limit(threads);
    Evaluation evaluation;
    evaluation.tracked = true;
    evaluation.body = paper_body();
    evaluation.sets.push_back(evaluate(5, [] { return TestTracker(); }, 50, {"clips", "memory", true}));
    EXPECT_EQ(evaluation.sets[0].failed, 1);
    EXPECT_THAT(evaluation.sets[0].failures, ElementsAre("frame 50: damaged"));
    EXPECT_EQ(evaluation.sets[0].frames, 5 * kFrames - 1);
    evaluation.sets[0].seconds = 0.0;
    reports.push_back(evaluation_json(evaluation));
  }
  EXPECT_EQ(reports[0], reports[1]);
  EXPECT_THAT(reports[0], HasSubstr("\"track.hota\""));
}

// Labels: threads
TEST(EvaluateSequences, KeepJointsAndPosturesInTheOrderOfTheRecordings) {
  const auto trackers = [] {
    return [tracker = TestTracker()](const Frame& frame) mutable {
      TrackedFrame tracked = tracker(frame);
      tracked.people[0].posture.emplace().chest_m = std::stof(frame.name);
      FittedBody& body = tracked.people[0].body.emplace();
      body.bones.resize(builtin_flesh().bones.size());
      for (FittedBone& bone : body.bones) {
        bone.state = State::observed;
        bone.of_head.misfit = std::stof(frame.name);
      }
      return tracked;
    };
  };
  const OpenTruth open = [] { return std::make_unique<Recordings>(3); };
  const SetOptions options{"clips", "memory"};
  EXPECT_TRUE(evaluate_sequences(open, options, judge(), trackers).trust_samples.empty()) << "not asked for";
  for_threads({1, 3}, [&] {
    const SetResult set = evaluate_sequences(open, options, judge(), trackers, {.trust = true});
    ASSERT_EQ(set.trust_samples.size(), 2U * 3U * kFrames) << "two joints of one person in each frame";
    for (std::size_t i = 0; i < set.trust_samples.size(); ++i) {
      EXPECT_EQ(set.trust_samples[i].signals.misfit, static_cast<float>(i / 2));
      EXPECT_TRUE(set.trust_samples[i].right) << "2 cm off";
    }
    const SetResult stances = evaluate_sequences(open, options, judge(), trackers, {.stances = true});
    ASSERT_EQ(stances.stance_samples.size(), 3U * kFrames);
    for (std::size_t i = 0; i < stances.stance_samples.size(); ++i) {
      EXPECT_EQ(stances.stance_samples[i].posture.chest_m, static_cast<float>(i));
      EXPECT_EQ(stances.stance_samples[i].stance, Stance::standing);
    }
  });
}

TEST(EvaluateSequences, CountAFrameWhoseTrackerFails) {
  const auto trackers = [] {
    return [tracker = TestTracker()](const Frame& frame) mutable {
      TrackedFrame tracked = tracker(frame);
      if (frame.name == "3") tracked.people.push_back(tracked.people[0]);
      return tracked;
    };
  };
  const SetResult set = evaluate(1, trackers, -1, {"clips", "memory", true});
  EXPECT_THAT(set.failures, ElementsAre("memory: frame 3: frame 3: two people of id 1"));
  EXPECT_EQ(set.frames, kFrames - 1);
}

/// Frames that are no recording, or recordings mixed with each other.
class Numbered : public Recordings {
 public:
  explicit Numbered(std::vector<int> numbers) : Recordings(1), numbers_(std::move(numbers)) {}
  std::optional<TrueFrame> next() override {
    std::optional<TrueFrame> frame = Recordings::next();
    if (frame) frame->truth.sequence = numbers_[at_++ % numbers_.size()];
    return frame;
  }

 private:
  std::vector<int> numbers_;
  std::size_t at_ = 0;
};

TEST(EvaluateSequences, RefuseFramesThatAreNoRecordingsAndCanBeStopped) {
  const auto of = [](std::vector<int> numbers) {
    return [numbers] {
      return evaluate_sequences([&] { return std::make_unique<Numbered>(numbers); }, {"clips", "memory", true}, judge(),
                                [] { return TestTracker(); });
    };
  };
  EXPECT_THAT(of({-1}), ThrowsMessage<Error>(HasSubstr("memory: frame 0 stands alone, expected recordings")));
  EXPECT_THAT(of({0, 1}), ThrowsMessage<Error>(HasSubstr("of recording 0 after one of recording 1")));
  EXPECT_THAT(
      [] {
        evaluate(
            1, [] { return TestTracker(); }, 2);
      },
      ThrowsMessage<Error>(HasSubstr("frame 2: damaged")));
  EvaluationHooks hooks;
  hooks.stop = [] { return true; };
  const SetOptions options{"clips", "memory"};
  EXPECT_THAT(
      [&] {
        evaluate(
            2, [] { return TestTracker(); }, -1, options, hooks);
      },
      ThrowsMessage<Error>(HasSubstr("clips: interrupted after ")));
}

}  // namespace
}  // namespace vesalius
