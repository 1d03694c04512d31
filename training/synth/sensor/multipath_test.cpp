#include "synth/sensor/multipath.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "synth/sensor/sensor.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

/// Returns a wall 3 m away and, if asked for, a floor 1 m below the camera, of a matt 0.8.
Rendering room(bool floor) {
  Rendering r;
  r.view.camera = resized(find_sensor("azure-kinect"), 320, 288).camera;
  const int width = r.view.camera.width, height = r.view.camera.height;
  r.depth_m = Image<float>(width, height);
  r.normal = Image<Vector3f>(width, height, Vector3f::Zero());
  r.infrared = Image<float>(width, height, 0.8F);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const Vector3f ray = r.view.camera.point(float(u), float(v), 1.F);
      const float to_floor = ray.y() > 0.F ? 1.F / ray.y() : 100.F;
      const bool down = floor && to_floor < 3.F;
      r.depth_m(u, v) = down ? to_floor : 3.F;
      r.normal(u, v) = down ? Vector3f(0.F, -1.F, 0.F) : Vector3f(0.F, 0.F, -1.F);
    }
  }
  return r;
}

float error_at(const Rendering& before, const Rendering& after, int u, int v) {
  return after.depth_m(u, v) - before.depth_m(u, v);
}

TEST(Multipath, LeavesAFlatWallWhereItIs) {
  const Rendering before = room(false);
  Rendering after = before;
  add_multipath(1.F, after);
  for (std::size_t i = 0; i < before.depth_m.size(); ++i) EXPECT_EQ(before.depth_m[i], after.depth_m[i]);
}

TEST(Multipath, RoundsACornerAndGrowsWithStrength) {
  const Rendering before = room(true);
  Rendering once = before, twice = before;
  add_multipath(1.F, once);
  add_multipath(2.F, twice);
  const Camera& camera = before.view.camera;
  const int u = 160, corner = int(camera.cy + camera.fy / 3.F);  // where the floor meets the wall
  // In the corner itself no way is longer than the straight one; far from it little light arrives. In between wall and
  // floor lie a centimetre deeper.
  const float beside = error_at(before, once, u, corner - 40);
  EXPECT_GT(beside, 0.008F);
  EXPECT_LT(beside, 0.05F);
  EXPECT_LT(error_at(before, once, u, corner - 4), 0.9F * beside);
  EXPECT_LT(error_at(before, once, u, 2), 0.9F * beside);
  EXPECT_GT(error_at(before, once, u, corner + 10), 0.003F);
  EXPECT_NEAR(error_at(before, twice, u, corner - 40), 2.F * beside, 0.4F * beside);
}

// The light of a floor on a spot of the wall, added up over a fine grid of the floor and with the library's functions.
TEST(Multipath, IsTheSumOverTheOtherSurface) {
  const Rendering before = room(true);
  Rendering after = before;
  add_multipath(1.F, after);
  const Camera& camera = before.view.camera;
  const int u = 165, v = int(camera.cy) + 25;
  const Vector3f spot = camera.point(float(u), float(v), 3.F);
  double along = 0.0, across = 0.0;
  constexpr double kStep = 0.01;
  const double half_width = 0.5 * camera.width / double(camera.fx);
  const double nearest = double(camera.fy) / (double(camera.height) - double(camera.cy));
  for (double z = nearest; z < 3.0; z += kStep) {
    for (double x = -half_width * z; x < half_width * z; x += kStep) {
      const double range = std::sqrt(x * x + 1.0 + z * z);
      const double dx = spot.x() - x, dy = spot.y() - 1.0, dz = 3.0 - z;
      const double squared = dx * dx + dy * dy + dz * dz;
      const double lit = (1.0 / range) / (range * range);  // what the camera's light brings to a square metre
      const double light = 0.8 / std::numbers::pi * lit * kStep * kStep * -dy * dz / (squared * squared);
      const double turns = 0.5 * (range + std::sqrt(squared) - double(spot.norm())) / 1.5;
      along += light * std::cos(2.0 * std::numbers::pi * turns);
      across += light * std::sin(2.0 * std::numbers::pi * turns);
    }
  }
  const double straight = 3.0 / double(spot.norm()) / double(spot.squaredNorm());
  const double error = std::atan2(across, straight + along) / (2.0 * std::numbers::pi) * 1.5;
  const double z_error = error * 3.0 / double(spot.norm());
  EXPECT_NEAR(double(error_at(before, after, u, v)), z_error, 0.15 * z_error);
  EXPECT_GT(z_error, 0.003);
}

// Floor by the wall gets little light straight, and strong light of the wall prevails.
TEST(Multipath, GrowsWithStrengthBeyondTheLightThatComesStraight) {
  const Rendering before = room(true);
  const Camera& camera = before.view.camera;
  const int u = 160, v = int(camera.cy + camera.fy / 3.F) + 10;
  float least = 0.F;
  for (const float strength : {1.F, 3.F, 10.F, 30.F, 100.F, 300.F}) {
    Rendering after = before;
    add_multipath(strength, after);
    const float error = error_at(before, after, u, v);
    EXPECT_GT(error, least) << strength;
    least = error;
  }
}

TEST(Multipath, LeavesEmptySpaceAndIsNothingWithoutStrength) {
  Rendering r = room(true);
  r.depth_m(7, 9) = 0.F;
  const Image<float> before = r.depth_m;
  add_multipath(0.F, r);
  EXPECT_EQ(r.depth_m, before);
  add_multipath(1.F, r);
  EXPECT_EQ(r.depth_m(7, 9), 0.F);
}

}  // namespace
}  // namespace vesalius::synth
