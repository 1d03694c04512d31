#include "metrics/reduce_forest.h"

#include <gmock/gmock.h>

#include "vesalius/base/error.h"
#include "vesalius/forest/label_pixels.h"

namespace vesalius {
namespace {

Forest three_leaves() {
  Forest forest;
  forest.body = paper_body();
  forest.has_background = true;
  forest.trees.resize(3);
  forest.trees[0].leaves = {{{4, 7, 25}, {60, 150, 45}}};
  forest.trees[1].leaves = {{{7, 4}, {100, 100}}};
  forest.trees[2].leaves = {{{25}, {255}}};
  return forest;
}

TEST(ReduceForest, KeepsOnlyTheLikeliestClassForHardVotes) {
  const Forest hard = with_hard_votes(three_leaves());
  EXPECT_TRUE(has_distributions(three_leaves()));
  EXPECT_FALSE(has_distributions(hard));
  EXPECT_EQ(hard.trees[0].leaves[0], (TreeLeaf{{7}, {255}}));
  EXPECT_EQ(hard.trees[1].leaves[0], (TreeLeaf{{7}, {255}}));
  const Posteriors votes = ForestLabeller(hard).label(DepthImage(1, 1, 2000), {1, 1, 500, 500, 0, 0});
  EXPECT_EQ(votes.at(0, 0)[7], 2 * 255);
  EXPECT_EQ(votes.at(0, 0)[25], 255);
  EXPECT_EQ(votes.at(0, 0)[4], 0);
}

TEST(ReduceForest, KeepsTheFirstTrees) {
  const Forest forest = three_leaves();
  const Forest two = with_first_trees(forest, 2);
  EXPECT_THAT(two.trees, testing::ElementsAre(forest.trees[0], forest.trees[1]));
  EXPECT_TRUE(two.has_background);
  EXPECT_EQ(two.convention, forest.convention);
  EXPECT_THROW(with_first_trees(forest, 0), Error);
  EXPECT_THROW(with_first_trees(forest, 4), Error);
}

TEST(ReduceForest, TakesForestsWhoseLeavesWereLearnedTogether) {
  Forest forest = three_leaves();
  forest.logit_unit = 0.05F;
  for (Tree& tree : forest.trees) tree.logits.assign(26 * tree.leaves.size(), 0);
  forest.trees[0].logits[7] = 90;
  forest.trees[1].logits[25] = 5;
  const Forest two = with_first_trees(forest, 2);
  check(two);
  EXPECT_EQ(two.logit_unit, forest.logit_unit);
  const Forest votes = with_hard_votes(forest);
  check(votes);
  EXPECT_EQ(votes.logit_unit, 0.F);
  EXPECT_EQ(votes.trees[0].leaves[0], (TreeLeaf{{7}, {255}}));
  EXPECT_EQ(votes.trees[1].leaves[0], (TreeLeaf{{25}, {255}}));
}

}  // namespace
}  // namespace vesalius
