#include "vesalius/forest.h"

#include <gmock/gmock.h>

#include <limits>

#include "vesalius/error.h"

namespace vesalius {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TreeLeaf vote(std::uint8_t label) {
  TreeLeaf leaf;
  leaf.label[0] = label;
  leaf.probability[0] = 255;
  return leaf;
}

/// Returns a forest of a root, one inner node on its right, and three leaves.
Forest small_forest() {
  Forest forest;
  forest.body = paper_body();
  Tree tree;
  tree.nodes = {{.du1 = 3, .left = ~0, .right = 1}, {.dv2 = -3, .left = ~1, .right = ~2}};
  tree.leaves = {vote(0), vote(10), vote(24)};
  forest.trees = {tree};
  return forest;
}

TEST(Forest, IsAcceptedIfConsistent) { EXPECT_NO_THROW(check(small_forest())); }

TEST(Forest, MayHaveATreeOfOneLeaf) {
  Forest forest = small_forest();
  forest.trees = {Tree{.nodes = {}, .leaves = {vote(1)}, .logits = {}}};
  EXPECT_NO_THROW(check(forest));
  EXPECT_EQ(depth(forest.trees[0]), 0);
}

TEST(Forest, HasABackgroundClassOnlyIfItSaysSo) {
  Forest forest = small_forest();
  forest.trees[0].leaves[1] = vote(25);
  EXPECT_THAT([&] { check(forest); }, ThrowsMessage<Error>(HasSubstr("leaf 1 names class 25 of 25")));
  forest.has_background = true;
  EXPECT_NO_THROW(check(forest));
}

TEST(Forest, MayHaveAnyLabelInAnUnusedSlot) {
  Forest forest = small_forest();
  forest.trees[0].leaves[0].label[3] = 200;
  EXPECT_NO_THROW(check(forest));
}

TEST(Forest, IsRefusedForChildrenOutsideTheArraysOrBeforeTheirParents) {
  for (const std::int32_t child : {0, 1, 2, ~3, std::numeric_limits<std::int32_t>::min()}) {
    Forest forest = small_forest();
    forest.trees[0].nodes[1].left = child;
    EXPECT_THAT([&] { check(forest); }, ThrowsMessage<Error>(HasSubstr("tree 0: node 1 has"))) << child;
  }
}

TEST(Forest, IsRefusedForOffsetsProbabilitiesOrTreesAboveTheirLimits) {
  Forest far = small_forest();
  far.trees[0].nodes[0].dv1 = kMaxOffset + 1;
  EXPECT_THAT([&] { check(far); }, ThrowsMessage<Error>(HasSubstr("offset 1024")));
  Forest sure = small_forest();
  sure.trees[0].leaves[0].probability[1] = 1;
  EXPECT_THAT([&] { check(sure); }, ThrowsMessage<Error>(HasSubstr("probabilities above 1")));
  Forest many = small_forest();
  many.trees.resize(257, many.trees[0]);
  EXPECT_THAT([&] { check(many); }, ThrowsMessage<Error>(HasSubstr("257 trees")));
}

TEST(Forest, IsRefusedIfAPieceIsMissing) {
  Forest no_trees = small_forest();
  no_trees.trees.clear();
  EXPECT_THROW(check(no_trees), Error);
  Forest no_body = small_forest();
  no_body.body = {};
  EXPECT_THROW(check(no_body), Error);
  Forest no_leaves = small_forest();
  no_leaves.trees[0] = {};
  EXPECT_THROW(check(no_leaves), Error);
  for (const float unit : {0.F, -1.F, std::numeric_limits<float>::quiet_NaN()}) {
    Forest no_unit = small_forest();
    no_unit.convention.offset_unit = unit;
    EXPECT_THROW(check(no_unit), Error);
  }
}

TEST(Forest, HasTheEdgesOfTheLongestBranchAsDepth) {
  EXPECT_EQ(depth(small_forest().trees[0]), 2);
  Tree chain;
  for (std::int32_t n = 0; n < 30; ++n) chain.nodes.push_back({.left = ~0, .right = n < 29 ? n + 1 : ~0});
  chain.leaves = {vote(0)};
  EXPECT_EQ(depth(chain), 30);
}

TEST(Forest, HasDistributionsIfLeavesHaveSeveralClasses) {
  Forest forest = small_forest();
  EXPECT_FALSE(has_distributions(forest));
  forest.trees[0].leaves[2].probability = {200, 55, 0, 0};
  EXPECT_TRUE(has_distributions(forest));
}

}  // namespace
}  // namespace vesalius
