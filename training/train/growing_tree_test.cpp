#include "train/growing_tree.h"

#include <gmock/gmock.h>

#include "train/samples/training_set.h"

namespace vesalius {
namespace {

/// Returns a set whose pictures have `pixels` readings of the two parts and the background, of which `samples` are
/// drawn.
TrainingSet set_with(int width, const SampleOptions& options) {
  BodyModel body;
  body.parts.resize(2);
  TrainingSet set(body, {}, options, 1);
  LabelledFrame frame;
  frame.frame.camera = {width, 10, 50.F, 50.F, 0.F, 0.F};
  frame.frame.depth = DepthImage(width, 10, 2000);
  frame.labels = LabelImage(width, 10, kBackground);
  for (int v = 0; v < 10; ++v) {
    frame.labels(0, v) = 0;
    frame.labels(1, v) = 1;
  }
  frame.labels(0, 0) = 1;
  set.add(frame);
  return set;
}

LeafShares shares_of(const TrainingSet& set, float prior_correction, float part_balance) {
  LeafOptions options;
  options.prior_correction = prior_correction;
  options.part_balance = part_balance;
  return {set.sample_counts(), set.body().part_count(), options};
}

SampleOptions half_background() {
  SampleOptions options;
  options.pixels_per_frame = 1000;
  options.background_share = 0.5F;
  options.held_out_share = 0.F;
  return options;
}

TEST(LeafShares, AreTheLargestFourRoundedDown) {
  BodyModel body;
  body.parts.resize(8);
  const TrainingSet set(body, {}, {}, 1);
  const std::vector<std::int64_t> counts{5, 10, 10, 0, 25, 0, 0, 50, 0};
  const TreeLeaf leaf = shares_of(set, 0.F, 0.F).leaf(counts.data());
  EXPECT_THAT(leaf.label, testing::ElementsAre(7, 4, 1, 2));
  EXPECT_THAT(leaf.probability, testing::ElementsAre(127, 63, 25, 25));  // floor(255 share)
}

TEST(LeafShares, AreCertainForOneClass) {
  const TrainingSet set = set_with(100, half_background());
  const std::vector<std::int64_t> counts{0, 3, 0};
  const TreeLeaf leaf = shares_of(set, 0.5F, 0.F).leaf(counts.data());
  EXPECT_EQ(leaf.label[0], 1);
  EXPECT_THAT(leaf.probability, testing::ElementsAre(255, 0, 0, 0));
}

TEST(LeafShares, UndoTheSamplingIfAsked) {
  const TrainingSet set =
      set_with(102, half_background());  // 9 + 11 of 1020 readings are body, but half of the samples are
  const std::vector<std::int64_t> counts{0, 50, 50};
  const auto share_of_background = [&](float correction) {
    const TreeLeaf leaf = shares_of(set, correction, 0.F).leaf(counts.data());
    return (leaf.label[0] == 2 ? leaf.probability[0] : leaf.probability[1]) / 255.0;
  };
  EXPECT_NEAR(share_of_background(0.F), 0.5, 0.005);
  // The odds are 1000 background readings to 20 of the body instead of 1 to 1. The parts' own shares differ by chance.
  EXPECT_NEAR(share_of_background(1.F), 1000.0 / 1020.0, 0.01);
  const double root = std::sqrt(50.0);
  EXPECT_NEAR(share_of_background(0.5F), root / (root + 1.0), 0.02);
}

TEST(LeafShares, CountPartsAlikeIfAskedAndKeepTheBackground) {
  const TrainingSet set = set_with(102, half_background());
  std::vector<std::int64_t> drawn(3, 0);
  for (const TrainingSample& sample : set.samples()) ++drawn[sample.label];
  ASSERT_GT(drawn[1], drawn[0]);
  const auto shares = [&](float balance) {
    const TreeLeaf leaf = shares_of(set, 0.F, balance).leaf(drawn.data());
    std::vector<double> of(3, 0.0);
    for (std::size_t k = 0; k < 3; ++k) of[leaf.label[k]] = leaf.probability[k] / 255.0;
    return of;
  };
  const double body = static_cast<double>(drawn[0] + drawn[1]) / static_cast<double>(set.samples().size());
  const double odds = static_cast<double>(drawn[1]) / static_cast<double>(drawn[0]);
  EXPECT_NEAR(shares(0.F)[1] / shares(0.F)[0], odds, 0.05);
  EXPECT_NEAR(shares(0.5F)[1] / shares(0.5F)[0], std::sqrt(odds), 0.05);
  EXPECT_NEAR(shares(1.F)[1], shares(1.F)[0], 0.005);
  for (const float balance : {0.F, 0.5F, 1.F}) {
    EXPECT_NEAR(shares(balance)[0] + shares(balance)[1], body, 0.01) << balance;
    EXPECT_NEAR(shares(balance)[2], 1.0 - body, 0.005) << balance;
  }
}

TEST(PrunedTree, MergesEqualLeavesUpToTheRoot) {
  TreeLeaf yes, no;
  yes.label[0] = 1;
  yes.probability[0] = 255;
  no.probability[0] = 255;
  // 0 -> (1 -> (yes, yes), 2 -> (no, 5 -> (yes, yes)))
  std::vector<GrownNode> nodes(9);
  const auto split = [&](std::size_t at, std::size_t left, std::int16_t threshold) {
    nodes[at].left = left;
    nodes[at].right = left + 1;
    nodes[at].split.threshold_mm = threshold;
  };
  split(0, 1, 10);
  split(1, 3, 20);
  split(2, 5, 30);
  split(6, 7, 40);
  for (const std::size_t leaf : {3U, 4U, 7U, 8U}) nodes[leaf].leaf = yes;
  nodes[5].leaf = no;
  const Tree tree = pruned_tree(nodes);
  ASSERT_EQ(tree.nodes.size(), 2U);
  EXPECT_THAT(tree.leaves, testing::ElementsAre(yes, no, yes));
  EXPECT_EQ(tree.nodes[0].threshold_mm, 10);
  EXPECT_EQ(tree.nodes[0].left, ~0);
  EXPECT_EQ(tree.nodes[0].right, 1);
  EXPECT_EQ(tree.nodes[1].threshold_mm, 30);
  EXPECT_EQ(tree.nodes[1].left, ~1);
  EXPECT_EQ(tree.nodes[1].right, ~2);
  nodes[5].leaf = yes;
  EXPECT_TRUE(pruned_tree(nodes).nodes.empty());
  EXPECT_THAT(pruned_tree(nodes).leaves, testing::ElementsAre(yes));
}

}  // namespace
}  // namespace vesalius
