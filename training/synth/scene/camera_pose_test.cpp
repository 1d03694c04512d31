#include "synth/scene/camera_pose.h"

#include <gmock/gmock.h>

#include <cmath>

#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(CameraPose, LooksAlongMinusZWhenLevel) {
  const Eigen::Isometry3f pose = CameraPose{1.5F, 0.F, 0.F}.world_from_camera();
  EXPECT_TRUE(pose.linear().isUnitary(1e-6F));
  EXPECT_NEAR(pose.linear().determinant(), 1.F, 1e-6F);
  EXPECT_TRUE((pose * Vector3f(0.F, 0.F, 2.F)).isApprox(Vector3f(0.F, 1.5F, -2.F)));
  EXPECT_TRUE((pose * Vector3f(1.F, 0.F, 0.F)).isApprox(Vector3f(1.F, 1.5F, 0.F)));
  EXPECT_TRUE((pose * Vector3f(0.F, 1.F, 0.F)).isApprox(Vector3f(0.F, 0.5F, 0.F)));
}

TEST(CameraPose, PitchTiltsDownAndRollTurnsTheHorizon) {
  const Eigen::Isometry3f down = CameraPose{2.F, 0.5F, 0.F}.world_from_camera();
  const Vector3f axis = down.linear().col(2);
  EXPECT_NEAR(axis.y(), -std::sin(0.5F), 1e-6F);
  EXPECT_NEAR(axis.z(), -std::cos(0.5F), 1e-6F);
  // With a clockwise roll the camera's right side goes down.
  EXPECT_NEAR((CameraPose{1.F, 0.F, 0.3F}.world_from_camera().linear().col(0)).y(), -std::sin(0.3F), 1e-6F);
}

TEST(CameraPose, RollsTheGivenShareWidely) {
  CameraPlacement options;
  options.rolled_share = 0.3F;
  int wide = 0;
  constexpr int kCameras = 2000;
  for (std::uint64_t i = 0; i < kCameras; ++i) {
    Random random(2, i), same(2, i);
    const CameraPose pose = sample_camera(options, 1.F, 2.F, random);
    const float roll_deg = std::abs(pose.roll_rad) * 57.29578F;
    EXPECT_LE(roll_deg, 90.01F);
    wide += roll_deg > options.roll_max_deg ? 1 : 0;
    EXPECT_EQ(sample_camera({}, 1.F, 2.F, same).pitch_rad, pose.pitch_rad);
  }
  EXPECT_NEAR(wide / static_cast<double>(kCameras), 0.3 * 86.0 / 90.0, 0.05);
}

TEST(CameraPose, StaysWithinTheOptions) {
  for (const char* mounting : {"room", "ceiling", "wheelchair"}) {
    const CameraPlacement options = camera_placement(mounting);
    check(options);
    int usual = 0;
    for (std::uint64_t i = 0; i < 1000; ++i) {
      Random random(1, i);
      const float far = sample_distance(options, random);
      EXPECT_GE(far, options.distance_min_m);
      EXPECT_LE(far, options.distance_max_m);
      usual += far >= options.usual_min_m && far <= options.usual_max_m ? 1 : 0;
      const CameraPose pose = sample_camera(options, 0.9F, far, random);
      EXPECT_GE(pose.height_m, options.height_min_m);
      EXPECT_LE(pose.height_m, options.height_max_m);
      constexpr float kDeg = 57.29578F;
      EXPECT_GE(pose.pitch_rad * kDeg, options.pitch_min_deg - 1e-3F);
      EXPECT_LE(pose.pitch_rad * kDeg, options.pitch_max_deg + 1e-3F);
      EXPECT_LE(std::abs(pose.roll_rad) * kDeg, options.roll_max_deg + 1e-3F);
    }
    EXPECT_GT(usual, 550) << mounting;
  }
}

TEST(CameraPose, LooksAtItsTarget) {
  CameraPlacement options;
  options.aim_error_deg = options.roll_max_deg = 0.F;
  for (std::uint64_t i = 0; i < 50; ++i) {
    Random random(2, i);
    const CameraPose pose = sample_camera(options, 1.F, 3.F, random);
    const Vector3f target = pose.world_from_camera() * Vector3f(0.F, 0.F, 3.F);
    EXPECT_NEAR(target.y(), 1.F, 1e-4F);
  }
}

TEST(CameraPose, NamesInvalidOptions) {
  EXPECT_THAT([] { camera_placement("roof"); }, ThrowsMessage<UsageError>(HasSubstr("room, ceiling or wheelchair")));
  CameraPlacement options;
  options.height_min_m = 2.F;
  options.height_max_m = 1.F;
  EXPECT_THAT([&] { check(options); },
              ThrowsMessage<UsageError>(HasSubstr("camera.height-min is 2, above camera.height-max 1")));
  options = {};
  options.distance_max_m = 50.F;
  EXPECT_THAT([&] { check(options); }, ThrowsMessage<UsageError>(HasSubstr("camera.distance-max")));
}

}  // namespace
}  // namespace vesalius::synth
