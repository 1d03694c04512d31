#include "capsule/capsule_shape.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

using Eigen::Vector3d;

CapsuleShape sphere(const Vector3d& centre, double radius) {
  return {Eigen::Matrix3d::Identity(), centre, Vector3d::Constant(radius), 0.0};
}

Vector3d random_vector(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

CapsuleShape random_shape(Random& random) {
  CapsuleShape shape;
  shape.world_from_shape =
      Eigen::AngleAxisd(random.uniform(0, 3), random_vector(random, 1.0).normalized()).toRotationMatrix();
  shape.centre_m = random_vector(random, 0.3) + Vector3d(0, 0, 3);
  shape.scale_m = {random.uniform(0.1, 0.4), random.uniform(0.1, 0.4), random.uniform(0.1, 0.4)};
  shape.half_length = random.uniform(0.0, 3.0);
  return shape;
}

/// Returns the distance from the unit capsule's axis segment in shape units; it is below 1 inside.
double radius_at(const CapsuleShape& shape, const Vector3d& world) {
  const Vector3d local = (shape.world_from_shape.transpose() * (world - shape.centre_m)).cwiseQuotient(shape.scale_m);
  const double on_axis = std::clamp(local.y(), -shape.half_length, shape.half_length);
  return (local - Vector3d(0, on_axis, 0)).norm();
}

TEST(CapsuleShape, IsMetByRaysWhereGeometrySays) {
  const auto hit = intersect(sphere({0, 0, 3}, 0.5), Vector3d::Zero(), Vector3d(0, 0, 1));
  ASSERT_TRUE(hit);
  EXPECT_DOUBLE_EQ(hit->t, 2.5);
  EXPECT_FALSE(intersect(sphere({0, 0, 3}, 0.5), Vector3d::Zero(), Vector3d(0.2, 0, 1)));
  EXPECT_FALSE(intersect(sphere({0, 0, -3}, 0.5), Vector3d::Zero(), Vector3d(0, 0, 1))) << "behind the origin";
  EXPECT_FALSE(intersect(sphere({0, 0, 0.2}, 0.5), Vector3d::Zero(), Vector3d(0, 0, 1))) << "starts inside";
}

TEST(CapsuleShape, IsMetAtTheNearEndByRaysAlongTheAxis) {
  CapsuleShape shape = sphere({0, 0, 3}, 0.5);
  shape.half_length = 2.0;
  const auto hit = intersect(shape, {0.0, -4.0, 3.0}, Vector3d(0, 1, 0));
  ASSERT_TRUE(hit);
  EXPECT_DOUBLE_EQ(hit->t, 4.0 - 1.5);
  EXPECT_FALSE(intersect(shape, {0.6, -4.0, 3.0}, Vector3d(0, 1, 0)));
}

// The oracle marches along the ray in small steps.
TEST(CapsuleShape, IsEnteredWhereMarchingAlongTheRaySays) {
  Random random(7);
  int hits = 0;
  for (int i = 0; i < 700; ++i) {
    const CapsuleShape shape = random_shape(random);
    const Vector3d ray(random.uniform(-0.25, 0.25), random.uniform(-0.25, 0.25), 1.0);
    double marched = -1.0, closest = 1e9;
    for (double t = 0.0; t < 6.0 && marched < 0.0; t += 0.001) {
      closest = std::min(closest, radius_at(shape, t * ray));
      if (closest < 1.0) marched = t;
    }
    const auto hit = intersect(shape, Vector3d::Zero(), ray);
    if (!hit) {
      EXPECT_GT(closest, 0.999) << "shape " << i;
      continue;
    }
    ++hits;
    EXPECT_NEAR(radius_at(shape, hit->t * ray), 1.0, 1e-9);
    // The march may miss a grazing entry between two steps.
    if (marched >= 0.0) {
      EXPECT_NEAR(hit->t, marched, 0.0011) << "shape " << i;
    }
  }
  EXPECT_GT(hits, 100);
}

TEST(CapsuleShape, HasNormalsAlongTheGradientOfTheRadius) {
  Random random(8);
  for (int i = 0; i < 100; ++i) {
    const CapsuleShape shape = random_shape(random);
    const Vector3d ray = shape.centre_m + random_vector(random, 0.05);
    const auto hit = intersect(shape, Vector3d::Zero(), ray);
    ASSERT_TRUE(hit);
    const Vector3d at = hit->t * ray;
    Vector3d gradient;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d step = 1e-6 * Vector3d::Unit(axis);
      gradient[axis] = radius_at(shape, at + step) - radius_at(shape, at - step);
    }
    EXPECT_GT(normal(shape, hit->local).dot(gradient.normalized()), 0.99999);
  }
}

TEST(CapsuleShape, GivesSlabsOfASphereTheirVolumesAndCentroids) {
  const CapsuleShape ball = sphere(Vector3d::Zero(), 0.5);
  const double volume = 4.0 / 3.0 * std::numbers::pi * 0.125;
  const Slab whole = measure_slab(ball, -5.0, 5.0);
  EXPECT_NEAR(whole.half_volume_m3, volume / 2, volume * 1e-3);
  EXPECT_NEAR(whole.y, 0.0, 1e-9);
  EXPECT_NEAR(whole.x, 3.0 / 8.0, 1e-3);  // half ball
  const Slab top = measure_slab(ball, 0.0, 5.0);
  EXPECT_NEAR(top.half_volume_m3, volume / 4, volume * 1e-3);
  EXPECT_NEAR(top.y, 3.0 / 8.0, 1e-3);
}

TEST(CapsuleShape, GivesSlabsOfTheStraightPartACylindersVolume) {
  CapsuleShape shape = sphere(Vector3d::Zero(), 0.5);
  shape.half_length = 2.0;
  const Slab slab = measure_slab(shape, 0.5, 1.5);
  EXPECT_NEAR(slab.half_volume_m3, std::numbers::pi * 0.25 * 0.5 / 2, 1e-6);
  EXPECT_NEAR(slab.y, 1.0, 1e-9);
  EXPECT_NEAR(slab.x, 4.0 / (3.0 * std::numbers::pi), 1e-6);
  EXPECT_EQ(measure_slab(shape, 4.0, 5.0).half_volume_m3, 0.0);
}

}  // namespace
}  // namespace vesalius
