#include "vesalius/track/track_floor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "capsule/capsule_person.h"
#include "vesalius/base/random.h"
#include "vesalius/planes/find_planes.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;

constexpr double kFrame_s = 1.0 / 30.0;
constexpr float kDegree = std::numbers::pi_v<float> / 180.F;

/// The floor under a camera that is tilted down and rolled clockwise.
Plane floor_under(float height_m, float tilt = 0.F, float roll = 0.F, float area_m2 = 4.F) {
  const Eigen::Matrix3f turn =
      (Eigen::AngleAxisf(-roll, Vector3f::UnitZ()) * Eigen::AngleAxisf(tilt, Vector3f::UnitX())).toRotationMatrix();
  return {turn * Vector3f::UnitY(), height_m, area_m2};
}

void show(TrackFloor& floor, const std::vector<Plane>& planes, int frames) {
  for (int i = 0; i < frames; ++i) floor.update(planes, std::nullopt, kFrame_s);
}

TEST(TrackFloor, TellsHeightTiltAndRoll) {
  const FloorView level = view_of_floor(floor_under(1.2F));
  EXPECT_NEAR((level.up - Vector3f(0.F, -1.F, 0.F)).norm(), 0.F, 1e-6F);
  EXPECT_NEAR(level.tilt_rad, 0.F, 1e-6F);
  EXPECT_NEAR(level.roll_rad, 0.F, 1e-6F);
  const FloorView view = view_of_floor(floor_under(1.2F, 0.4F, 0.2F));
  EXPECT_NEAR(view.tilt_rad, 0.4F, 1e-5F);
  EXPECT_NEAR(view.roll_rad, 0.2F, 1e-5F);
  EXPECT_FLOAT_EQ(view.height_m, 1.2F);
}

TEST(TrackFloor, FindsTheFloorOfARenderedRoomAndItsTilt) {
  CapsuleScene scene;
  scene.floor_y_m = 1.1F;
  scene.pitch = 0.3F;
  const Camera camera{320, 240, 262.5F, 262.5F, 159.5F, 119.5F};
  const LabelledFrame room = render(scene, camera, paper_body());
  TrackFloor floor;
  show(floor, find_planes(room.frame.depth, camera, {}), 15);
  ASSERT_TRUE(floor.view());
  EXPECT_NEAR(floor.view()->tilt_rad, 0.3F, 0.01F);
  EXPECT_NEAR(floor.view()->roll_rad, 0.F, 0.01F);
  EXPECT_NEAR(floor.view()->height_m, 1.1F, 0.01F);
}

TEST(TrackFloor, ATableSeenForAMomentIsNoFloor) {
  TrackFloor floor;
  show(floor, {floor_under(0.5F)}, 3);
  EXPECT_FALSE(floor.view());
  show(floor, {floor_under(1.2F), floor_under(0.5F)}, 15);
  ASSERT_TRUE(floor.view());
  EXPECT_NEAR(floor.view()->height_m, 1.2F, 1e-3F);
  show(floor, {floor_under(0.5F)}, 60);  // somebody hides the floor for two seconds
  EXPECT_NEAR(floor.view()->height_m, 1.2F, 1e-3F);
}

TEST(TrackFloor, AFloorBelowATableTakesItsPlace) {
  TrackFloor floor;
  show(floor, {floor_under(0.5F)}, 60);
  ASSERT_TRUE(floor.view());
  EXPECT_NEAR(floor.view()->height_m, 0.5F, 1e-3F) << "nothing else was seen";
  show(floor, {floor_under(0.5F), floor_under(1.2F)}, 15);
  EXPECT_NEAR(floor.view()->height_m, 1.2F, 1e-3F);
}

TEST(TrackFloor, AveragesTheNoiseOfAStillCamera) {
  Random random(1);
  TrackFloor floor;
  double squares = 0.0;
  for (int i = 0; i < 300; ++i) {
    const auto off = static_cast<float>(random.normal(0.0, 0.01));
    const auto tilt = static_cast<float>(random.normal(0.0, 0.2)) * kDegree;
    floor.update({floor_under(1.2F + off, 0.3F + tilt)}, std::nullopt, kFrame_s);
    if (i >= 150) squares += std::pow(static_cast<double>(floor.view()->height_m) - 1.2, 2.0);
  }
  EXPECT_LT(std::sqrt(squares / 150.0), 0.003) << "a third of a frame's error of 1 cm at most";
}

TEST(TrackFloor, FollowsACameraThatTurns) {
  TrackFloor floor;
  float tilt = 0.F;
  for (int i = 0; i < 90; ++i) {
    tilt = 0.5F * kDegree * static_cast<float>(i);  // 15 degrees a second
    floor.update({floor_under(1.2F, tilt)}, std::nullopt, kFrame_s);
  }
  EXPECT_NEAR(floor.view()->tilt_rad, tilt, 3.F * kDegree);
}

TEST(TrackFloor, UpThatASensorMeasuredTellsFloorFromWall) {
  // The camera lies on its side; the plane that looks like a floor in the picture is a wall.
  const Plane wall = floor_under(1.5F), ground{Vector3f::UnitX(), 0.9F, 4.F};
  TrackFloor floor;
  for (int i = 0; i < 15; ++i) floor.update({wall, ground}, Vector3f(-1.F, 0.F, 0.F), kFrame_s);
  ASSERT_TRUE(floor.view());
  EXPECT_NEAR(floor.view()->height_m, 0.9F, 1e-3F);
  EXPECT_NEAR(floor.view()->roll_rad, 0.5F * std::numbers::pi_v<float>, 1e-3F);
}

TEST(TrackFloor, IsForgottenWhenItIsLongGone) {
  TrackFloor floor;
  const Plane wall{Vector3f::UnitZ(), 3.F, 6.F};
  show(floor, {floor_under(1.2F), wall}, 15);
  show(floor, {wall}, 30 * 19);
  EXPECT_TRUE(floor.view());
  show(floor, {wall}, 60);
  EXPECT_FALSE(floor.view());
}

TEST(TrackFloor, IsForgottenSoonByACameraThatIsTurnedAway) {
  const Plane wall{Vector3f::UnitZ(), 3.F, 6.F}, ceiling{-Vector3f::UnitY(), 1.4F, 5.F};
  TrackFloor floor;
  show(floor, {floor_under(1.2F), wall}, 15);
  show(floor, {wall}, 60);
  EXPECT_TRUE(floor.view()) << "something hides it";
  show(floor, {ceiling}, 40);
  EXPECT_FALSE(floor.view());
}

TEST(TrackFloor, FloorsFrameIsLevel) {
  const FloorView view = view_of_floor(floor_under(1.2F, 0.4F, 0.2F));
  const Eigen::Isometry3f level = floor_from_optical(view);
  const Eigen::Matrix3f should_be_one = level.linear() * level.linear().transpose();
  EXPECT_NEAR((should_be_one - Eigen::Matrix3f::Identity()).norm(), 0.F, 1e-5F);
  EXPECT_NEAR(level.linear().determinant(), 1.F, 1e-5F);
  EXPECT_NEAR((level * Vector3f(0.F, 0.F, 0.F) - Vector3f(0.F, -1.2F, 0.F)).norm(), 0.F, 1e-5F) << "the camera";
  const Vector3f ahead = level * Vector3f(0.F, 0.F, 2.F);
  EXPECT_NEAR((ahead - Vector3f(0.F, -1.2F + 2.F * std::sin(0.4F), 2.F * std::cos(0.4F))).norm(), 0.F, 1e-5F);
  const Vector3f below = level * Vector3f(-1.2F * view.up);
  EXPECT_NEAR(below.norm(), 0.F, 1e-5F) << "the floor below the camera";
  const Eigen::Isometry3f straight = floor_from_optical(view_of_floor(floor_under(1.F)));
  EXPECT_NEAR((straight * Vector3f(0.3F, 0.2F, 2.F) - Vector3f(0.3F, -0.8F, 2.F)).norm(), 0.F, 1e-5F);
  const Eigen::Isometry3f down = floor_from_optical(view_of_floor({Vector3f::UnitZ(), 2.F, 4.F}));
  EXPECT_NEAR((down * Vector3f(0.3F, -0.2F, 2.F) - Vector3f(0.3F, 0.F, 0.2F)).norm(), 0.F, 1e-5F);
}

}  // namespace
}  // namespace vesalius
