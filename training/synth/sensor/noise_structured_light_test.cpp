#include <gmock/gmock.h>

#include <cmath>

#include "synth/sensor/sensor_noise.h"
#include "synth/sensor/test_noise_scene.h"

namespace vesalius::synth {
namespace {

using test::board;
using test::sensor_named;
using test::statistics_of;
using test::tilt;
using test::wall;

TEST(StructuredLight, ErrsByTheFormulaOfNguyen) {
  const Sensor sensor = resized(sensor_named("kinect-v1"), 160, 120);
  for (const float z : {1.F, 2.F, 3.F, 4.F}) {
    const double expected = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
    EXPECT_NEAR(statistics_of(sensor, z).sigma_m, expected, 0.1 * expected) << z;
  }
}

TEST(StructuredLight, ErrsMoreOnSlantedSurfaces) {
  const Sensor sensor = resized(sensor_named("kinect-v1"), 160, 120);
  for (const float angle : {1.05F, 1.25F}) {
    const double t = angle / (1.5707963 - angle);
    const double expected = 0.0012 + 0.0019 * 0.36 + 0.0001 * t * t;
    const double sigma_m = statistics_of(sensor, 1.F, [&](Rendering& r) { tilt(r, angle); }).sigma_m;
    EXPECT_NEAR(sigma_m, expected, 0.1 * expected) << angle;
  }
}

TEST(StructuredLight, ReadsDisparitiesInEighthsOfAPixel) {
  const Sensor sensor = resized(sensor_named("kinect-v1"), 160, 120);
  for (const float z : {1.3F, 2.7F, 6.F}) {
    for (const std::uint16_t depth_mm : sense(wall(sensor.camera, z), sensor, Random(2))) {
      if (depth_mm == 0) continue;
      const double eighths = std::round(8.0 * 580.0 * 75.0 / depth_mm);
      ASSERT_NEAR(depth_mm, 8.0 * 580.0 * 75.0 / eighths, 0.51) << z;
    }
  }
}

/// Returns the mean number of pixels without a reading in columns [begin, end).
double hole_width(const DepthImage& depth, int begin, int end) {
  int holes = 0;
  for (int v = 0; v < depth.height(); ++v)
    holes += static_cast<int>(std::count(depth.row(v) + begin, depth.row(v) + end, 0));
  return static_cast<double>(holes) / depth.height();
}

TEST(StructuredLight, LosesTheProjectorsShadowExceptItsRims) {
  Sensor sensor = sensor_named("kinect-v1-raw");
  sensor.edge_loss = 0.F;
  Rendering r = board(sensor.camera, 1.2F, 3.F, 300, 420);
  const int shadow_px = static_cast<int>(std::lround(580.0 * 0.075 * (1.0 / 1.2 - 1.0 / 3.0)));
  ASSERT_EQ(shadow_px, 22);
  for (int v = 0; v < 480; ++v) std::fill(r.lit.row(v) + 300 - shadow_px, r.lit.row(v) + 300, 0);
  const DepthImage depth = sense(r, sensor, Random(3));
  EXPECT_NEAR(hole_width(depth, 250, 350), shadow_px - 2.0 * sensor.fatten_px, 1.0);
  EXPECT_LT(hole_width(depth, 400, 460), 0.1);
}

TEST(StructuredLight, LosesPixelsHiddenFromTheDisplacedEye) {
  Sensor sensor = sensor_named("kinect-v1");
  sensor.edge_loss = 0.F;
  const DepthImage depth = sense(board(sensor.camera, 1.F, 3.F, 300, 420), sensor, Random(4));
  const double hidden_px = 525.0 * 0.025 * (1.0 - 1.0 / 3.0);  // 8.75
  EXPECT_NEAR(hole_width(depth, 400, 460), hidden_px - 2.0 * sensor.fatten_px, 1.0);
  EXPECT_LT(hole_width(depth, 260, 320), 0.1);
}

TEST(StructuredLight, ThinsOutTheBackgroundAlongSilhouettes) {
  Sensor sensor = sensor_named("kinect-v1-raw");
  sensor.edge_loss = 0.4F;
  sensor.fatten_px = 0.F;
  sensor.lateral_px = 0.F;
  const DepthImage depth = sense(board(sensor.camera, 2.F, 3.F, 300, 420), sensor, Random(5));
  const int reach_px = static_cast<int>(sensor.edge_px);
  EXPECT_NEAR(hole_width(depth, 420, 420 + reach_px) / reach_px, 0.4, 0.08);
  EXPECT_LT(hole_width(depth, 420 + reach_px, 500), 0.1);
  EXPECT_LT(hole_width(depth, 310, 410), 0.1);
}

TEST(StructuredLight, MakesSilhouettesWobbleByItsLateralNoise) {
  Sensor sensor = sensor_named("kinect-v1-raw");
  sensor.edge_loss = sensor.fatten_px = 0.F;
  const DepthImage depth = sense(board(sensor.camera, 2.F, 3.F, 200, 420), sensor, Random(6));
  double square = 0.0;
  for (int v = 0; v < 480; ++v) {
    const auto near =
        std::count_if(depth.row(v) + 300, depth.row(v) + 480, [](auto mm) { return mm != 0 && mm < 2500; });
    square += (static_cast<double>(near) - 120.0) * (static_cast<double>(near) - 120.0);
  }
  EXPECT_NEAR(std::sqrt(square / 480.0), 0.8, 0.25);
}

}  // namespace
}  // namespace vesalius::synth
