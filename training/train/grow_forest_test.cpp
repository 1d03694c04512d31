#include "train/grow_forest.h"

#include <gmock/gmock.h>

#include <limits>

#include "capsule/capsule_person.h"
#include "train/split_candidates.h"
#include "vesalius/error.h"
#include "vesalius/forest/tree_walk.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

const Camera kCamera{160, 120, 131.F, 131.F, 79.5F, 59.5F};

TrainOptions small_options() {
  TrainOptions options;
  options.trees = 3;
  options.grow.leaf.max_depth = 10;
  options.sample.pixels_per_frame = 300;
  options.grow.split.candidates = 20;
  options.grow.leaf.min_samples = 5;
  return options;
}

std::vector<LabelledFrame> standing_people(int count) {
  std::vector<LabelledFrame> frames;
  for (int i = 0; i < count; ++i) {
    CapsuleScene scene;
    CapsulePerson person;
    person.feet = {-0.5F + 0.1F * static_cast<float>(i % 11), 1.F, 2.F + 0.05F * static_cast<float>(i % 20)};
    person.pose.yaw = 0.05F * static_cast<float>(i % 9 - 4);
    person.pose.l_arm.raise = 0.2F * static_cast<float>(i % 7);
    scene.people.push_back(person);
    frames.push_back(render(scene, kCamera, paper_body()));
  }
  return frames;
}

int likeliest(const Forest& forest, const LabelledFrame& frame, int u, int v) {
  const OffsetScaler scaler(forest.convention, frame.frame.camera);
  std::vector<int> sums(forest.class_count(), 0);
  for (const Tree& tree : forest.trees) {
    const TreeLeaf& leaf = walk(tree, frame.frame.depth, forest.convention, scaler.at(frame.frame.depth(u, v)), u, v);
    for (std::size_t k = 0; k < TreeLeaf::kClasses; ++k) sums[leaf.label[k]] += leaf.probability[k];
  }
  return static_cast<int>(std::ranges::max_element(sums) - sums.begin());
}

double share_right(const Forest& forest, const std::vector<LabelledFrame>& frames) {
  int right = 0, all = 0;
  for (const LabelledFrame& frame : frames) {
    for (int v = 0; v < kCamera.height; ++v) {
      for (int u = 0; u < kCamera.width; ++u) {
        if (frame.labels(u, v) == kBackground) continue;
        right += likeliest(forest, frame, u, v) == frame.labels(u, v);
        ++all;
      }
    }
  }
  return static_cast<double>(right) / all;
}

TEST(GrowForest, LearnsToLabelAStandingPerson) {
  const std::vector<LabelledFrame> all = standing_people(60);
  const std::vector<LabelledFrame> seen(all.begin(), all.begin() + 50), unseen(all.begin() + 50, all.end());
  const Forest forest = grow_forest(seen, paper_body(), small_options());
  EXPECT_TRUE(forest.has_background);
  EXPECT_EQ(forest.trees.size(), 3U);
  EXPECT_TRUE(has_distributions(forest));
  EXPECT_GT(share_right(forest, unseen), 0.85);
}

// The shelf's upper half is one part and its lower half another. They can be told apart by what is above and below
// them.
TEST(GrowForest, SolvesAToyProblem) {
  BodyModel body;
  body.parts.resize(2);
  LabelledFrame frame;
  frame.frame.camera = {64, 48, 60.F, 60.F, 31.5F, 23.5F};
  frame.frame.depth = DepthImage(64, 48, 2000);
  frame.labels = LabelImage(64, 48, 0);
  for (int v = 24; v < 48; ++v) {
    for (int u = 0; u < 64; ++u) frame.labels(u, v) = 1;
  }
  for (int v = 12; v < 36; ++v) {
    for (int u = 0; u < 64; ++u) frame.frame.depth(u, v) = static_cast<std::uint16_t>(v < 24 ? 1500 : 1700);
  }
  TrainOptions options = small_options();
  options.sample.background_share = 0.F;
  options.grow.split.candidates = 100;
  const Forest forest = grow_forest({frame}, body, options);
  EXPECT_FALSE(forest.has_background);
  int wrong = 0;
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 64; ++u) wrong += likeliest(forest, frame, u, v) != frame.labels(u, v);
  }
  EXPECT_LE(wrong, 64 * 48 / 50);
}

TEST(TrainingConvention, HasOffsetsThatReachTheFurthestProbeWithinAByte) {
  for (const bool half_normal : {false, true}) {
    for (const float furthest_m : {0.1F, 0.5F, 0.64F, 1.5F, 10.F}) {
      TrainOptions options;
      options.grow.split = {.max_offset_m = furthest_m, .half_normal = half_normal, .one_sided = 0.F};
      const FeatureConvention convention = training_convention(options);
      EXPECT_GE(convention.offset_unit, FeatureConvention{}.offset_unit) << "finer than a sensor sees";
      Random random(3);
      const CandidateTable table = draw_candidates(convention, options.grow.split, 20000, random);
      const auto [low, high] = std::ranges::minmax(table.offsets);
      EXPECT_GE(low, -128);
      EXPECT_LE(high, 127);
      EXPECT_NEAR(convention.offset_unit * static_cast<float>(high), furthest_m, 0.1F * furthest_m);
      EXPECT_NEAR(convention.offset_unit * static_cast<float>(low), -furthest_m, 0.1F * furthest_m);
    }
  }
}

// Labels: threads
TEST(GrowForest, GrowsTheSameForestOnAnyNumberOfThreads) {
  const std::vector<LabelledFrame> frames = standing_people(6);
  const auto grow = [&](int threads) {
    const ThreadLimit limit(threads);
    return grow_forest(frames, paper_body(), small_options()).trees;
  };
  EXPECT_EQ(grow(1), grow(2));
}

TEST(GrowForest, GrowsTheSameForestWithLittleMemory) {
  const std::vector<LabelledFrame> frames = standing_people(6);
  TrainOptions options = small_options();
  const std::vector<Tree> trees = grow_forest(frames, paper_body(), options).trees;
  options.grow.row_bytes = 20000;
  EXPECT_EQ(grow_forest(frames, paper_body(), options).trees, trees);
}

TEST(GrowForest, GrowsDifferentTreesForDifferentNumbersAndSeeds) {
  const std::vector<LabelledFrame> frames = standing_people(3);
  TrainOptions options = small_options();
  const Forest forest = grow_forest(frames, paper_body(), options);
  EXPECT_NE(forest.trees[0], forest.trees[1]);
  options.grow.seed = 2;
  EXPECT_NE(grow_forest(frames, paper_body(), options).trees, forest.trees);
}

TEST(GrowForest, RespectsItsLimits) {
  const std::vector<LabelledFrame> frames = standing_people(6);
  TrainOptions options = small_options();
  options.grow.leaf.max_depth = 4;
  for (const Tree& tree : grow_forest(frames, paper_body(), options).trees) {
    EXPECT_LE(depth(tree), 4);
    EXPECT_EQ(tree.leaves.size(), tree.nodes.size() + 1);
  }
  options.grow.leaf.max_depth = 0;
  for (const Tree& tree : grow_forest(frames, paper_body(), options).trees) EXPECT_TRUE(tree.nodes.empty());
  options.grow.leaf.max_depth = 20;
  options.grow.leaf.min_samples = 200;
  for (const Tree& tree : grow_forest(frames, paper_body(), options).trees) EXPECT_LE(tree.leaves.size(), 9U);
}

TEST(GrowForest, RefusesUnusableInput) {
  EXPECT_THROW(grow_forest({}, paper_body(), {}), Error);
  EXPECT_THROW(grow_forest(standing_people(1), BodyModel{}, {}), Error);
  std::vector<LabelledFrame> holes = standing_people(1);
  holes[0].frame.depth.fill(0);
  EXPECT_THROW(grow_forest(holes, paper_body(), {}), Error);
  TrainOptions options;
  options.grow.leaf.max_depth = 31;
  EXPECT_THROW(grow_forest(standing_people(1), paper_body(), options), UsageError);
  options = {};
  options.sample.background_share = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(grow_forest(standing_people(1), paper_body(), options), UsageError);
}

}  // namespace
}  // namespace vesalius
