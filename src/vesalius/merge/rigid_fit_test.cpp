#include "vesalius/merge/rigid_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

Vector3d any_point(Random& random) {
  return {random.uniform(-2.0, 2.0), random.uniform(-1.0, 1.0), random.uniform(1.0, 5.0)};
}

Isometry3d any_motion(Random& random) {
  Isometry3d motion = Isometry3d::Identity();
  motion.linear() = Eigen::AngleAxisd(random.uniform(-3.0, 3.0), any_point(random).normalized()).toRotationMatrix();
  motion.translation() = any_point(random);
  return motion;
}

std::vector<PointPair> pairs_of(const Isometry3d& motion, int count, double noise_m, Random& random) {
  std::vector<PointPair> pairs;
  for (int i = 0; i < count; ++i) {
    const Vector3d from = any_point(random);
    const Vector3d off(random.normal(0.0, noise_m), random.normal(0.0, noise_m), random.normal(0.0, noise_m));
    pairs.push_back({motion * from + off, from, 0.03 * 0.03});
  }
  return pairs;
}

double place_error(const Isometry3d& a, const Isometry3d& b) { return (a.translation() - b.translation()).norm(); }
double turn_error(const Isometry3d& a, const Isometry3d& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

TEST(RigidFit, FindsWhatMovedThePoints) {
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    const Isometry3d motion = any_motion(random);
    const auto fit = rigid_fit(pairs_of(motion, 3 + i, 0.0, random));
    ASSERT_TRUE(fit);
    EXPECT_LT(place_error(*fit, motion), 1e-8);
    EXPECT_LT(turn_error(*fit, motion), 1e-8);
    EXPECT_NEAR(fit->linear().determinant(), 1.0, 1e-9);
  }
}

TEST(RigidFit, HeedsVariances) {
  Random random(2);
  const Isometry3d motion = any_motion(random);
  std::vector<PointPair> pairs = pairs_of(motion, 20, 0.0, random);
  for (PointPair bad : pairs_of(motion, 20, 1.0, random)) {
    bad.variance_m2 = 1e6;
    pairs.push_back(bad);
  }
  EXPECT_LT(place_error(rigid_fit(pairs).value(), motion), 1e-3);
}

TEST(RigidFit, NeedsMoreThanALine) {
  std::vector<PointPair> pairs;
  for (int i = 0; i < 10; ++i) pairs.push_back({Vector3d(0.0, i, 2.0), Vector3d(1.0, i, 3.0)});
  EXPECT_FALSE(rigid_fit(pairs));
  EXPECT_FALSE(rigid_fit({{Vector3d::Zero(), Vector3d::Zero()}, {Vector3d::UnitX(), Vector3d::UnitX()}}));
}

TEST(RigidRefine, IsNotMisledByAFifthOfWrongPairs) {
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    const Isometry3d motion = any_motion(random);
    std::vector<PointPair> pairs = pairs_of(motion, 200, 0.02, random);
    for (int bad = 0; bad < 40; ++bad) pairs[std::size_t(bad)].to += any_point(random);
    const Isometry3d fit = rigid_refine(rigid_fit(pairs).value(), pairs, std::nullopt);
    EXPECT_LT(place_error(fit, motion), 0.02);
    EXPECT_LT(turn_error(fit, motion), 0.01);
  }
}

TEST(RigidRefine, TakesWhatTheFloorTells) {
  Random random(4);
  // Two level cameras, 1 m and 1.4 m over the floor, y down.
  Isometry3d motion = Isometry3d::Identity();
  motion.linear() = Eigen::AngleAxisd(1.2, Vector3d::UnitY()).toRotationMatrix();
  motion.translation() = Vector3d(2.0, -0.4, 1.0);
  std::vector<PointPair> pairs = pairs_of(motion, 30, 0.0, random);
  for (PointPair& pair : pairs) pair.to.y() += 0.05 + 0.05 * pair.to.z();  // all joints err alike, and lean
  const FloorPair floor{-Vector3d::UnitY(), -Vector3d::UnitY(), 1.0, 1.4};
  const Isometry3d without = rigid_refine(motion, pairs, std::nullopt), with = rigid_refine(motion, pairs, floor);
  EXPECT_GT(turn_error(without, motion), 0.03);
  EXPECT_LT(turn_error(with, motion), 0.01);
  EXPECT_NEAR(with.translation().y(), -0.4, 0.02);
}

}  // namespace
}  // namespace vesalius
