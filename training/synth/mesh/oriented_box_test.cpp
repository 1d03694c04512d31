#include "synth/mesh/oriented_box.h"

#include <gtest/gtest.h>

#include "vesalius/base/random.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

float within(double low, double high, Random& random) { return static_cast<float>(random.uniform(low, high)); }

Vector3f point_within(double reach, Random& random) {
  Vector3f point;
  for (float& at : point) at = within(-reach, reach, random);
  return point;
}

OrientedBox random_box(Random& random) {
  // One after the other: compilers differ in the order in which they evaluate arguments.
  OrientedBox box;
  const Vector3f place = point_within(1.0, random), axis = point_within(1.0, random).normalized();
  box.pose = Eigen::Translation3f(place) * Eigen::AngleAxisf(within(0.0, 3.0, random), axis);
  for (float& half : box.half) half = within(0.05, 0.8, random);
  return box;
}

TEST(OrientedBox, HasTheDistanceToTheNearestFaceAsDepth) {
  OrientedBox box;
  box.pose = Eigen::Translation3f(1.F, 2.F, 3.F) * Eigen::AngleAxisf(1.5707964F, Vector3f::UnitY());
  box.half = {0.5F, 1.F, 2.F};  // after the turn, 2 along world x and 0.5 along world z
  EXPECT_NEAR(depth_inside(box, {1.F, 2.F, 3.F}), 0.5F, 1e-6F);
  EXPECT_NEAR(depth_inside(box, {2.9F, 2.F, 3.F}), 0.1F, 1e-5F);
  EXPECT_NEAR(depth_inside(box, {1.F, 2.F, 3.6F}), -0.1F, 1e-5F);
}

TEST(OrientedBox, OverlapsWhereSampledPointsAreInBothBoxes) {
  Random random(1);
  int overlapping = 0;
  for (int i = 0; i < 400; ++i) {
    const OrientedBox a = random_box(random), b = random_box(random);
    bool common = false;
    for (int k = 0; k < 40000 && !common; ++k) {
      const Vector3f p = a.pose * Vector3f(point_within(1.0, random).cwiseProduct(a.half));
      common = depth_inside(b, p) > 0.F;
    }
    EXPECT_TRUE(!common || overlap(a, b, 0.F)) << i;
    overlapping += common ? 1 : 0;
    EXPECT_TRUE(common || !overlap(a, b, 0.1F)) << i;  // an overlap this deep has room for points
    EXPECT_EQ(overlap(a, b, 0.F), overlap(b, a, 0.F));
  }
  EXPECT_GT(overlapping, 50);
  EXPECT_LT(overlapping, 350);
}

TEST(OrientedBox, BlocksLinesWithAPointInside) {
  Random random(2);
  int blocked = 0;
  for (int i = 0; i < 500; ++i) {
    const OrientedBox box = random_box(random);
    const Vector3f a = point_within(2.0, random), b = point_within(2.0, random);
    float deepest = -1.F;
    for (int k = 0; k <= 2000; ++k) {
      deepest = std::max(deepest, depth_inside(box, a + (b - a) * static_cast<float>(k) / 2000.F));
    }
    if (std::abs(deepest) < 2e-3F) continue;  // the line only grazes the box
    EXPECT_EQ(blocks(box, a, b), deepest > 0.F) << i;
    blocked += deepest > 0.F ? 1 : 0;
  }
  EXPECT_GT(blocked, 25);
}

TEST(OrientedBox, MovesWithItsParent) {
  Random random(3);
  const OrientedBox box = random_box(random);
  const Eigen::Isometry3f motion = Eigen::Translation3f(1.F, 2.F, 3.F) * Eigen::AngleAxisf(0.7F, Vector3f::UnitZ());
  const Vector3f p = point_within(1.0, random);
  EXPECT_NEAR(depth_inside(moved(box, motion), motion * p), depth_inside(box, p), 1e-5F);
  for (const Vector3f& corner : corners(box)) EXPECT_NEAR(depth_inside(box, corner), 0.F, 1e-5F);
}

}  // namespace
}  // namespace vesalius::synth
