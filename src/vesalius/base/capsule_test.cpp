#include "vesalius/base/capsule.h"

#include <gtest/gtest.h>

namespace vesalius {
namespace {

TEST(Capsule, DistanceIsFromTheRoundedSurface) {
  const Capsule capsule{{0.F, 0.F, 2.F}, {1.F, 0.F, 2.F}, 0.1F, 0.3F};
  EXPECT_FLOAT_EQ(capsule.distance({0.5F, 1.F, 2.F}), 0.8F) << "the radius half way is 0.2";
  EXPECT_FLOAT_EQ(capsule.distance({-1.F, 0.F, 2.F}), 0.9F);
  EXPECT_FLOAT_EQ(capsule.distance({1.F, 0.F, 3.F}), 0.7F);
  EXPECT_FLOAT_EQ(capsule.distance({0.F, 0.F, 2.F}), -0.1F);
}

TEST(Capsule, ABallIsOneToo) {
  const Capsule ball{{0.F, 0.F, 1.F}, {0.F, 0.F, 1.F}, 0.5F, 0.5F};
  EXPECT_FLOAT_EQ(ball.distance({0.F, 2.F, 1.F}), 1.5F);
  EXPECT_FLOAT_EQ(ball.distance({0.F, 0.F, 1.F}), -0.5F);
}

}  // namespace
}  // namespace vesalius
