#include "train/leaves/learn_leaves.h"

#include <gtest/gtest.h>

#include <cmath>

#include "capsule/capsule_person.h"
#include "train/grow_forest.h"
#include "train/samples/sample_accuracy.h"
#include "train/test_training.h"
#include "vesalius/base/random.h"
#include "vesalius/base/test_threads.h"

namespace vesalius {
namespace {

using test::train_over;

constexpr Camera kCamera{80, 60, 66.F, 66.F, 39.5F, 29.5F};

/// Returns noisy frames of people turned any way round, with an empty room now and then.
std::vector<LabelledFrame> frames_of(int count, std::uint64_t seed) {
  std::vector<LabelledFrame> frames;
  for (int i = 0; i < count; ++i) {
    Random random(seed, static_cast<std::uint64_t>(i));
    CapsuleScene scene;
    if (i % 7 != 6) {
      CapsulePerson person;
      person.pose.yaw = static_cast<float>(random.uniform(-3.14, 3.14));
      person.pose.l_arm.raise = static_cast<float>(random.uniform(0.2, 2.5));
      person.pose.r_leg.forward = static_cast<float>(random.uniform(0.0, 1.0));
      person.feet.x() = static_cast<float>(random.uniform(-0.5, 0.5));
      scene.people = {person};
    }
    frames.push_back(render(scene, kCamera, paper_body()));
    add_sensor_noise(frames.back().frame, static_cast<std::uint64_t>(i));
  }
  return frames;
}

TrainOptions small_options(int rounds) {
  TrainOptions options;
  options.trees = 3;
  options.hard_trees = 1;
  options.sample.pixels_per_frame = 150;
  options.sample.held_out_share = 0.25F;
  options.sample.hard_pool = 50;
  options.grow.leaf.max_depth = 7;
  options.grow.leaf.min_samples = 8;
  options.grow.split.candidates = 12;
  options.leaves.rounds = rounds;
  options.leaves.portions = 2;
  return options;
}

/// Notes the rounds of learning leaves, and may stop after some of them.
class Listener : public TrainObserver {
 public:
  explicit Listener(int stop_after = 1000) : stop_after_(stop_after) {}
  bool end_leaf_round(int round, int /*rounds*/, double likelihood) override {
    rounds.push_back(round);
    likelihoods.push_back(likelihood);
    return static_cast<int>(rounds.size()) < stop_after_;
  }
  std::vector<int> rounds;
  std::vector<double> likelihoods;

 private:
  int stop_after_;
};

Forest train_over(const std::vector<int>& ends, const std::vector<LabelledFrame>& frames, const TrainOptions& options) {
  MemoryTreeStore store;
  Listener listener;
  return train_over(ends, frames, options, store, listener);
}

void expect_same(const Forest& a, const Forest& b) {
  EXPECT_EQ(a.trees, b.trees);
  EXPECT_EQ(a.logit_unit, b.logit_unit);
  EXPECT_EQ(a.facing, b.facing);
}

// Labels: threads
TEST(LearnLeaves, GivesTheSameForestForAnyNumberOfShardsAndThreads) {
  const std::vector<LabelledFrame> frames = frames_of(240, 1);
  const TrainOptions options = small_options(5);
  const Forest whole = train_over({240}, frames, options);
  ASSERT_GT(whole.logit_unit, 0.F);
  ASSERT_FALSE(whole.facing.empty()) << "all headings are among the held-out people";
  expect_same(train_over({61, 240}, frames, options), whole);
  expect_same(train_over({3, 4, 4, 90, 240}, frames, options), whole);
  for_threads({1, 3}, [&] { expect_same(train_over({50, 240}, frames, options), whole); });
}

TEST(LearnLeaves, ContinuesWhereItWasStopped) {
  const std::vector<LabelledFrame> frames = frames_of(60, 2);
  const TrainOptions options = small_options(7);
  const Forest whole = train_over({60}, frames, options);
  for (const int stop_after : {1, 4, 6}) {
    MemoryTreeStore store;
    Listener first(stop_after), second;
    EXPECT_THROW(train_over({60}, frames, options, store, first), Interrupted);
    expect_same(train_over({60}, frames, options, store, second), whole);
    ASSERT_FALSE(second.rounds.empty());
    EXPECT_EQ(second.rounds.front(), stop_after);
  }
}

TEST(LearnLeaves, IgnoresAStoreOfOtherTrees) {
  const std::vector<LabelledFrame> frames = frames_of(60, 2);
  const TrainOptions options = small_options(2);
  const Forest whole = train_over({60}, frames, options);
  MemoryTreeStore store;
  store.save_leaves({1, {64, {{1, 2, 3}}}});
  Listener listener;
  expect_same(train_over({60}, frames, options, store, listener), whole);
  EXPECT_EQ(listener.rounds.front(), 0);
}

TEST(LearnLeaves, MakesTheTruthLikelier) {
  const std::vector<LabelledFrame> frames = frames_of(400, 3);
  TrainOptions options = small_options(12);
  MemoryTreeStore store;
  Listener listener;
  const Forest learned = train_over({400}, frames, options, store, listener);
  EXPECT_GT(listener.likelihoods.back(), listener.likelihoods.front());
  options.leaves.rounds = 0;
  const Forest grown = train_over({400}, frames, options, store, listener);
  TrainingSet judge(paper_body(), training_convention(options), options.sample, 1);
  for (const LabelledFrame& frame : frames_of(100, 4)) judge.add(frame);
  const SampleAccuracy after = held_out_accuracy(learned, judge);
  const SampleAccuracy before = held_out_accuracy(grown, judge);
  EXPECT_GT(after.with_background(), before.with_background()) << "on people that neither has seen";
}

TEST(LearnLeaves, LeavesSharesWithoutRoundsOrBackground) {
  const std::vector<LabelledFrame> frames = frames_of(30, 5);
  EXPECT_EQ(train_over({30}, frames, small_options(0)).logit_unit, 0.F);
  TrainOptions options = small_options(3);
  options.sample.background_share = 0.F;
  EXPECT_EQ(train_over({30}, frames, options).logit_unit, 0.F);
}

TEST(LearnLeaves, CanDoWithoutHeadings) {
  TrainOptions options = small_options(3);
  options.leaves.headings = 0;
  const Forest forest = train_over({60}, frames_of(60, 6), options);
  EXPECT_GT(forest.logit_unit, 0.F);
  EXPECT_EQ(forest.headings, 0);
  EXPECT_TRUE(forest.facing.empty());
  EXPECT_EQ(forest.trees[0].logits.size(), forest.trees[0].leaves.size() * 26);
  options.leaves.headings = 3;
  EXPECT_THROW(check(options), UsageError);
}

/// A shard of one tree without decisions: every sample reaches its only leaf.
TEST(LearnLeaves, FindsTheSharesOfASingleLeaf) {
  TrainOptions options = small_options(60);
  options.trees = 1;
  options.hard_trees = 0;
  options.grow.leaf.max_depth = 0;
  options.sample.held_out_share = 0.F;
  options.leaves.headings = 0;
  options.leaves.portions = 1;
  options.leaves.prior = 0.F;
  options.leaves.part_balance = 0.F;
  options.leaves.lift = 0.F;
  const std::vector<LabelledFrame> frames = frames_of(20, 7);
  const Forest forest = train_over({20}, frames, options);
  TrainingSet set(paper_body(), training_convention(options), options.sample, 1);
  for (const LabelledFrame& frame : frames) set.add(frame);
  std::vector<double> shares(26, 0.0);
  for (const TrainingSample& sample : set.samples()) {
    shares[sample.label] += 1.0 / static_cast<double>(set.samples().size());
  }
  const std::vector<std::int8_t>& logits = forest.trees[0].logits;
  double all = 0.0;
  for (int c = 0; c < 26; ++c) all += std::exp(static_cast<double>(logits[c]) * forest.logit_unit);
  for (int c = 0; c < 26; ++c) {
    EXPECT_NEAR(std::exp(static_cast<double>(logits[c]) * forest.logit_unit) / all, shares[c], 0.03);
  }
}

constexpr int kParts = 3, kSides = 4;

/// Returns people whose features tell the heading through noise; heading 0 is `more` times as frequent.
std::vector<FacingSample> people(int count, int more, std::uint64_t seed) {
  Random random(seed, 0);
  std::vector<FacingSample> samples;
  for (int i = 0; i < count; ++i) {
    const auto drawn = static_cast<int>(random.below(static_cast<std::uint32_t>(kSides - 1 + more)));
    FacingSample sample{std::vector<float>(kParts * kSides + kParts + 1, 0.F), drawn < kSides ? drawn : 0};
    for (float& feature : sample.features) feature = static_cast<float>(random.uniform(-1.0, 1.0));
    sample.features[kSides + sample.heading] += 1.5F;
    sample.features.back() = 1.F;
    samples.push_back(sample);
  }
  return samples;
}

double share_right(const FacingModel& model, const std::vector<FacingSample>& samples) {
  double right = 0.0;
  for (const FacingSample& sample : samples) {
    const Eigen::Map<const Eigen::VectorXf> features(sample.features.data(),
                                                     static_cast<Eigen::Index>(sample.features.size()));
    Eigen::Index best = 0;
    facing(model, features).maxCoeff(&best);
    right += best == sample.heading ? 1.0 : 0.0;
  }
  return right / static_cast<double>(samples.size());
}

TEST(FitFacing, LearnsWhichFeaturesTellTheHeading) {
  const FacingModel model = fit_facing(people(800, 1, 1), kParts, kSides);
  EXPECT_GT(share_right(model, people(400, 1, 2)), 0.8);
}

TEST(FitFacing, ExpectsFrequentHeadingsHalfAsMuchMoreOften) {
  const FacingModel model = fit_facing(people(4000, 9, 3), kParts, kSides);
  Eigen::VectorXf nothing = Eigen::VectorXf::Zero(kParts * kSides + kParts + 1);
  nothing[nothing.size() - 1] = 1.F;
  const Eigen::VectorXf before = facing(model, nothing);
  EXPECT_GT(before[0], before[1]);
  EXPECT_LT(before[0], 9.F * before[1]);
}

TEST(FitFacing, GivesNoModelWithoutPeopleOfEveryHeading) {
  EXPECT_TRUE(fit_facing({}, kParts, kSides).empty());
  std::vector<FacingSample> some = people(100, 1, 4);
  std::erase_if(some, [](const FacingSample& sample) { return sample.heading == 2; });
  EXPECT_TRUE(fit_facing(some, kParts, kSides).empty());
  EXPECT_TRUE(fit_facing(people(10, 1, 5), kParts, 0).empty());
}

}  // namespace

}  // namespace vesalius
