#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "capsule/capsule_person.h"
#include "vesalius/base/test_threads.h"

namespace vesalius {
namespace {

const Camera kCamera{320, 240, 290.F, 290.F, 159.5F, 119.5F};

Frame wall(int z_mm) {
  Frame frame;
  frame.camera = kCamera;
  frame.depth = DepthImage(kCamera.width, kCamera.height, static_cast<std::uint16_t>(z_mm));
  return frame;
}

double share_of_holes(const DepthImage& depth) {
  return static_cast<double>(std::ranges::count(depth, 0)) / static_cast<double>(depth.size());
}

// The spread is that of the axial noise plus the rounding of the disparity, which is uniform over one step.
TEST(SensorNoise, HasTheFormulasSpreadOnAWall) {
  for (const int z_mm : {1000, 2000, 3500}) {
    Frame frame = wall(z_mm);
    add_sensor_noise(frame, 1);
    double sum = 0.0, squares = 0.0;
    int count = 0;
    for (int v = 100; v < 140; ++v) {
      for (int u = 140; u < 180; ++u) {  // columns that face the wall
        ASSERT_NE(frame.depth(u, v), 0);
        const double error = frame.depth(u, v) - z_mm;
        sum += error;
        squares += error * error;
        ++count;
      }
    }
    const double z = z_mm / 1000.0;
    const double axial_mm = 1.2 + 1.9 * (z - 0.4) * (z - 0.4);
    const double step_mm = 1000.0 * z * z / (580.0 * 0.075 * 8.0);
    const double expected = std::sqrt(axial_mm * axial_mm + step_mm * step_mm / 12.0);
    const double mean = sum / count;
    EXPECT_NEAR(std::sqrt(squares / count - mean * mean), expected, 0.15 * expected) << z_mm;
    EXPECT_NEAR(mean, 0.0, 0.15 * step_mm + 0.5) << z_mm;
  }
}

TEST(SensorNoise, ReadsDepthInDisparitySteps) {
  Frame frame = wall(3000);
  add_sensor_noise(frame, 2);
  for (const std::uint16_t read : frame.depth) {
    if (read == 0) continue;
    const double eighths = 580.0 * 75.0 / read * 8.0;
    const double step_mm = read / eighths;
    ASSERT_NEAR(eighths, std::round(eighths), 0.51 / step_mm) << read;
  }
}

TEST(SensorNoise, LeavesHolesAtTheBorders) {
  Frame frame = wall(2000);
  add_sensor_noise(frame, 3);
  const int border = kCamera.width / 80;
  for (int v = 0; v < kCamera.height; ++v) {
    EXPECT_EQ(frame.depth(border - 1, v), 0);
    EXPECT_EQ(frame.depth(kCamera.width - border, v), 0);
    EXPECT_NE(frame.depth(border, v), 0);
  }
}

TEST(SensorNoise, CastsAShadowAsWideAsTheBaselineImplies) {
  Frame frame = wall(4000);
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 150; u < 200; ++u) frame.depth(u, v) = 1000;
  }
  add_sensor_noise(frame, 4);
  const int width = static_cast<int>(290.0 * 0.075 * (1.0 / 1.0 - 1.0 / 4.0));  // 16 pixels
  for (int v = 5; v < 235; ++v) {
    for (int u = 150 - width; u < 150; ++u) EXPECT_EQ(frame.depth(u, v), 0) << u;
    for (int u = 203; u < 220; ++u) EXPECT_NE(frame.depth(u, v), 0) << u << ": lit on the projector's side";
    EXPECT_NE(frame.depth(150 - width - 4, v), 0);
  }
}

TEST(SensorNoise, LosesHalfOfTheSilhouette) {
  Frame frame = wall(1500);
  for (int v = 0; v < kCamera.height; ++v) {
    for (int u = 0; u < 160; ++u) frame.depth(u, v) = 1200;  // an edge on the lit side
  }
  add_sensor_noise(frame, 5);
  int lost = 0;
  for (int v = 0; v < kCamera.height; ++v) lost += frame.depth(159, v) == 0;
  EXPECT_NEAR(lost, kCamera.height / 2, 35);  // 4.5 sigma
}

TEST(SensorNoise, LosesSurfacesAtGrazingAngles) {
  CapsuleScene scene;
  scene.wall_z_m = 0.F;
  scene.floor_y_m = 0.3F;
  Frame floor = render(scene, kCamera, paper_body()).frame;
  add_sensor_noise(floor, 6);
  EXPECT_EQ(floor.depth(160, 130), 0) << "floor 8 m ahead, seen at 2 degrees";
  EXPECT_NE(floor.depth(160, 235), 0) << "floor 0.75 m ahead, seen at 22 degrees";
}

TEST(SensorNoise, ReadsNothingOutOfRange) {
  Frame near = wall(300);
  add_sensor_noise(near, 7);
  EXPECT_EQ(share_of_holes(near.depth), 1.0);
  Frame far = wall(12000);
  add_sensor_noise(far, 7);
  EXPECT_GT(share_of_holes(far.depth), 0.95);
}

// Labels: threads
TEST(SensorNoise, GivesTheSameBytesForAnyNumberOfThreads) {
  CapsuleScene scene;
  scene.people.emplace_back();
  const LabelledFrame clean = render(scene, kCamera, paper_body());
  const auto noisy = [&](std::uint64_t seed) {
    Frame frame = clean.frame;
    add_sensor_noise(frame, seed);
    return frame.depth;
  };
  std::vector<DepthImage> results;
  for_threads({1, 2, 8}, [&] { results.push_back(noisy(1)); });
  EXPECT_THAT(results, testing::Each(results[0]));
  EXPECT_NE(results[0], noisy(2)) << "another seed";
  EXPECT_LT(share_of_holes(results[0]), 0.15);
}

}  // namespace
}  // namespace vesalius
