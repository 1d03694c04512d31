#include "vesalius/boosted_trees.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "vesalius/error.h"

namespace vesalius {
namespace {

/// One tree that asks for two features: 0.5 for the first, then, where that is above, 2 for the second.
BoostedTrees two_questions() {
  BoostedTrees asked{2, -1.F, {}};
  BoostedTree& tree = asked.trees.emplace_back();
  tree.threshold.fill(std::numeric_limits<float>::infinity());
  tree.threshold[0] = 0.5F;
  tree.feature[2] = 1;
  tree.threshold[2] = 2.F;
  tree.value[0] = 10.F;   // not above
  tree.value[8] = 20.F;   // above, not above
  tree.value[12] = 30.F;  // above both
  return asked;
}

float odds(float log_odds) { return 1.F / (1.F + std::exp(-log_odds)); }

TEST(BoostedTrees, AddsTheValuesOfTheLeavesReached) {
  BoostedTrees asked = two_questions();
  for (float& value : asked.trees[0].value) value *= 0.1F;
  EXPECT_FLOAT_EQ(asked.probability({0.5F, 9.F}), odds(0.F)) << "what equals the threshold is not above";
  EXPECT_FLOAT_EQ(asked.probability({0.6F, 2.F}), odds(1.F));
  EXPECT_FLOAT_EQ(asked.probability({0.6F, 2.1F}), odds(2.F));
  asked.trees.push_back(asked.trees.front());
  EXPECT_FLOAT_EQ(asked.probability({0.6F, 2.1F}), odds(5.F));
}

TEST(BoostedTrees, AreRefusedWhenInconsistent) {
  EXPECT_NO_THROW(check(two_questions(), "trees"));
  EXPECT_NO_THROW(check(BoostedTrees{}, "trees"));
  BoostedTrees bad = two_questions();
  bad.features = 1;
  EXPECT_THROW(check(bad, "trees"), Error);
  bad = two_questions();
  bad.trees[0].value[3] = std::nanf("");
  EXPECT_THROW(check(bad, "trees"), Error);
  bad = two_questions();
  bad.trees[0].threshold[0] = std::nanf("");
  EXPECT_THROW(check(bad, "trees"), Error);
  bad = two_questions();
  bad.bias = std::numeric_limits<float>::infinity();
  EXPECT_THROW(check(bad, "trees"), Error);
}

TEST(BoostedTrees, AreServedByName) {
  BoostedTrees asked = two_questions();
  asked.asks = {"first", "second"};
  const BoostedTrees served = in_order(asked, {"other", "second", "first"}, "trees");
  EXPECT_EQ(served.features, 3);
  EXPECT_EQ(served.probability({-1.F, 9.F, 0.6F}), asked.probability({0.6F, 9.F}));
  EXPECT_EQ(served.probability({9.F, 1.F, 0.6F}), asked.probability({0.6F, 1.F}));
  EXPECT_EQ(in_order(asked, asked.asks, "trees"), asked);
  try {
    in_order(asked, {"first", "other"}, "judge");
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "forest: its judge asks for \"second\", which this program does not know");
  }
}

TEST(BoostedTrees, WithoutNamesHaveTheUsualOrder) {
  const BoostedTrees asked = two_questions();
  EXPECT_EQ(in_order(asked, {"any", "names"}, "trees"), asked);
  EXPECT_THROW(in_order(asked, {"any", "other", "names"}, "trees"), Error);
}

}  // namespace
}  // namespace vesalius
