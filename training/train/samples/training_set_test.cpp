#include "train/samples/training_set.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <set>

#include "capsule/capsule_person.h"
#include "train/samples/walk_samples.h"
#include "vesalius/error.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

const Camera kCamera{80, 60, 66.F, 66.F, 39.5F, 29.5F};

LabelledFrame frame_with(int people) {
  CapsuleScene scene;
  for (int i = 0; i < people; ++i) scene.people.emplace_back();
  return render(scene, kCamera, paper_body());
}

TrainingSet set_of(int frames, const SampleOptions& options, std::uint64_t seed = 1) {
  TrainingSet set(paper_body(), {}, options, seed);
  for (int i = 0; i < frames; ++i) set.add(frame_with(i % 4 == 3 ? 0 : 1));
  return set;
}

std::vector<std::tuple<int, int, int>> places(std::span<const TrainingSample> samples) {
  std::vector<std::tuple<int, int, int>> result;
  for (const TrainingSample& each : samples) result.emplace_back(each.frame, each.u, each.v);
  return result;
}

/// Returns a forest that takes every surface more than 10 cm in front of what is at its right for a chest.
Forest credulous_forest() {
  Forest forest;
  forest.body = paper_body();
  forest.has_background = true;
  Tree tree;
  TreeNode node;
  node.du2 = 100;
  node.threshold_mm = -100;
  node.left = ~0;
  node.right = ~1;
  tree.nodes.push_back(node);
  tree.leaves.resize(2);
  tree.leaves[0].label[0] = 24;
  tree.leaves[0].probability[0] = 200;
  tree.leaves[1].label[0] = 25;
  tree.leaves[1].probability[0] = 255;
  forest.trees.push_back(tree);
  return forest;
}

/// Adds hard negatives as the driver does with one shard.
std::size_t add_hard_negatives(TrainingSet& set, const Forest& forest, float hard_share) {
  const HardCounts hard = set.count_hard_negatives(forest);
  return set.add_hard_negatives(
      hard_cut(hard, static_cast<std::uint64_t>(hard_share * static_cast<float>(hard.background))));
}

TEST(TrainingSet, HoldsBackItsShareOfFramesFromLearning) {
  SampleOptions options;
  options.held_out_share = 0.25F;
  const TrainingSet set = set_of(12, options);
  std::set<std::uint32_t> learned, kept;
  for (const TrainingSample& each : set.samples()) learned.insert(each.frame);
  for (const TrainingSample& each : set.held_out()) kept.insert(each.frame);
  EXPECT_THAT(kept, testing::ElementsAre(3, 7, 11));
  EXPECT_EQ(learned.size(), 9U);
  for (const std::uint32_t frame : kept) EXPECT_FALSE(learned.contains(frame));
  EXPECT_TRUE(std::ranges::is_sorted(set.samples(), {}, &TrainingSample::frame));
  options.held_out_share = 0.F;
  EXPECT_TRUE(set_of(12, options).held_out().empty());
}

TEST(TrainingSet, DependsOnTheSeedAlone) {
  EXPECT_EQ(places(set_of(4, {}).samples()), places(set_of(4, {}).samples()));
  EXPECT_NE(places(set_of(4, {}).samples()), places(set_of(4, {}, 2).samples()));
}

TEST(TrainingSet, CountsOnlyPixelsOfFramesForLearning) {
  SampleOptions options;
  options.held_out_share = 0.5F;
  const LabelledFrame frame = frame_with(1);
  TrainingSet set(paper_body(), {}, options, 1);
  for (int i = 0; i < 4; ++i) set.add(frame);
  const int chest = paper_body().find_part("l_chest");
  const auto pixels = std::ranges::count(frame.labels, static_cast<std::uint8_t>(chest));
  ASSERT_GT(pixels, 0);
  EXPECT_EQ(set.class_pixels()[chest], 2U * static_cast<std::uint64_t>(pixels));
}

TEST(TrainingSet, AddsBackgroundThatAForestTakesForABody) {
  SampleOptions options;
  options.held_out_share = 0.F;
  const Forest forest = credulous_forest();
  TrainingSet set = set_of(8, options);
  const std::vector<TrainingSample> before(set.samples().begin(), set.samples().end());
  const std::size_t added = add_hard_negatives(set, forest, 10.F);
  ASSERT_GT(added, 0U) << "pixels beside the picture's right edge lie before what is far";
  EXPECT_EQ(set.samples().size(), before.size() + added);
  EXPECT_TRUE(std::ranges::is_sorted(set.samples(), {}, &TrainingSample::frame));
  std::multiset<std::tuple<int, int, int>> rest;
  for (const auto& place : places(set.samples())) rest.insert(place);
  for (const auto& place : places(before)) rest.erase(rest.find(place));
  for (const TrainingSample& each : set.samples()) {
    const auto found = rest.find({each.frame, each.u, each.v});
    if (found == rest.end()) continue;
    EXPECT_EQ(each.label, 25);
    EXPECT_EQ(leaf_of(forest.trees[0], set.frames(), each), 0U);
  }
  EXPECT_EQ(add_hard_negatives(set, forest, 10.F), 0U) << "the pool is used up";
}

// Labels: threads
TEST(TrainingSet, LimitsHardNegativesOnAnyNumberOfThreads) {
  SampleOptions options;
  options.held_out_share = 0.F;
  const auto grow = [&](int threads) {
    const ThreadLimit limit(threads);
    TrainingSet set = set_of(8, options);
    const auto background = std::ranges::count(set.samples(), std::uint8_t{25}, &TrainingSample::label);
    EXPECT_EQ(add_hard_negatives(set, credulous_forest(), 0.05F),
              static_cast<std::size_t>(0.05F * static_cast<double>(background)));
    return places(set.samples());
  };
  EXPECT_EQ(grow(1), grow(3));
}

TEST(TrainingSet, ReportsItsMemory) {
  const TrainingSet set = set_of(20, {});
  EXPECT_GE(set.bytes(), set.frames().bytes() + set.samples().size() * sizeof(TrainingSample));
  EXPECT_LT(set.bytes(), set.frames().bytes() + 20U * 4U * 2000U * sizeof(TrainingSample));
}

TEST(TrainingSet, RefusesBodiesWithoutPartsAndBadOptions) {
  EXPECT_THROW(TrainingSet(BodyModel{}, {}, {}, 1), Error);
  SampleOptions options;
  options.background_share = 1.5F;
  EXPECT_THROW(TrainingSet(paper_body(), {}, options, 1), UsageError);
}

const Camera kLargeCamera{160, 120, 131.F, 131.F, 79.5F, 59.5F};

LabelledFrame one_frame(bool person = true) {
  CapsuleScene scene;
  if (person) scene.people.emplace_back();
  return render(scene, kLargeCamera, paper_body());
}

std::vector<TrainingSample> sample(const LabelledFrame& frame, const SampleOptions& options, std::uint64_t seed = 1) {
  Random random(seed);
  return draw_samples(frame, paper_body(), options, random, "frame").samples;
}

std::map<int, int> count_labels(const std::vector<TrainingSample>& samples) {
  std::map<int, int> counts;
  for (const TrainingSample& each : samples) ++counts[each.label];
  return counts;
}

TEST(SamplePixels, TakesLabelsAndDepthFromTheFrame) {
  const LabelledFrame frame = one_frame();
  for (const TrainingSample& each : sample(frame, {})) {
    const int truth = frame.labels(each.u, each.v);
    EXPECT_EQ(each.label, truth == kBackground ? 25 : truth);
    ASSERT_NE(each.depth_mm, 0);
    EXPECT_EQ(each.depth_mm, frame.frame.depth(each.u, each.v));
  }
}

TEST(SamplePixels, GivesTheBackgroundItsShare) {
  SampleOptions options;
  options.pixels_per_frame = 1000;
  options.background_share = 0.3F;
  EXPECT_EQ(count_labels(sample(one_frame(), options))[25], 300);
  EXPECT_EQ(sample(one_frame(false), options).size(), 300U) << "an empty room has no body pixels";
  options.background_share = 0.F;
  EXPECT_EQ(count_labels(sample(one_frame(), options)).count(25), 0U);
}

TEST(SamplePixels, DrawsBalancedPartsEquallyOften) {
  SampleOptions options;
  options.pixels_per_frame = 25000;
  options.background_share = 0.F;
  options.balanced_share = 1.F;
  for (const auto& [label, count] : count_labels(sample(one_frame(), options))) {
    EXPECT_NEAR(count, 1000, 150) << label;  // 5 sigma
  }
  options.balanced_share = 0.F;
  std::map<int, int> counts = count_labels(sample(one_frame(), options));
  EXPECT_GT(counts[paper_body().find_part("l_chest")], 5 * counts[paper_body().find_part("l_elbow")]);
}

TEST(SamplePixels, DrawsNearBackgroundBesidePeople) {
  const LabelledFrame frame = one_frame();
  SampleOptions options;
  options.background_share = 1.F;
  options.near_share = 1.F;
  options.near_px = 5;
  const auto beside = [&](const TrainingSample& each) {
    for (int dv = -5; dv <= 5; ++dv) {
      for (int du = -5; du <= 5; ++du) {
        const int u = each.u + du, v = each.v + dv;
        if (frame.labels.contains(u, v) && frame.labels(u, v) != kBackground) return true;
      }
    }
    return false;
  };
  const std::vector<TrainingSample> samples = sample(frame, options);
  EXPECT_GT(std::ranges::count_if(samples, beside), 0.9 * static_cast<double>(samples.size()));
}

TEST(SamplePixels, DrawsAPoolOfBackgroundThatIsLargerInEmptyRooms) {
  SampleOptions options;
  options.hard_pool = 50;
  Random random(1);
  const DrawnSamples with = draw_samples(one_frame(), paper_body(), options, random, "frame");
  EXPECT_EQ(with.pool.size(), 50U);
  EXPECT_EQ(count_labels(with.pool)[25], 50);
  EXPECT_EQ(draw_samples(one_frame(false), paper_body(), options, random, "frame").pool.size(), 200U);
}

TEST(SamplePixels, CountsReadingsOfEveryClass) {
  LabelledFrame frame = one_frame();
  frame.frame.depth(0, 0) = 0;
  frame.frame.depth(1, 0) = 1000;
  frame.labels(1, 0) = 3;
  std::vector<std::uint64_t> truth(26, 0);
  for (std::size_t i = 0; i < frame.labels.size(); ++i) {
    if (frame.frame.depth[i] != 0) ++truth[frame.labels[i] == kBackground ? 25 : frame.labels[i]];
  }
  Random random(1);
  EXPECT_EQ(draw_samples(frame, paper_body(), {}, random, "frame").class_pixels, truth);
}

TEST(SamplePixels, NamesUnusableFrames) {
  Random random(1);
  LabelledFrame frame = one_frame();
  frame.labels(3, 4) = 25;
  frame.frame.depth(3, 4) = 1000;
  try {
    draw_samples(frame, paper_body(), {}, random, "training frame 7");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("training frame 7: label 25 at pixel (3, 4)"));
  }
  frame = one_frame();
  frame.labels = LabelImage(10, 10);
  EXPECT_THROW(draw_samples(frame, paper_body(), {}, random, "frame"), Error);
}

}  // namespace

}  // namespace vesalius
