#include "synth/sensor/sensor_variety.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace vesalius::synth {
namespace {

TEST(SensorVariety, IsThePresetByDefault) {
  for (const Sensor& preset : sensors()) {
    const VariedSensor drawn = draw_sensor({}, preset, Random(1, 2));
    EXPECT_EQ(drawn.sensor.matching_px, preset.matching_px);
    EXPECT_EQ(drawn.sensor.min_infrared, preset.min_infrared);
    EXPECT_EQ(drawn.sensor.mixed_px, preset.mixed_px);
    EXPECT_EQ(drawn.sensor.border_high, preset.border_high);
    EXPECT_EQ(drawn.stray_light, 0.F);
    EXPECT_EQ(drawn.multipath, 0.F);
    EXPECT_EQ(drawn.true_focal_share, 1.F);
    EXPECT_EQ(drawn.resampling.scale, 1.F);
  }
}

TEST(SensorVariety, StaysWithinItsRanges) {
  SensorVariety options;
  options.matching_max = 8.F;
  options.dim_max = 10.F;
  options.flying_max = 4.F;
  options.stray_light_max = 0.1F;
  options.border_max = 0.1F;
  options.focal_error = 0.05F;
  const Sensor& preset = find_sensor("azure-kinect");
  float brightest = 100.F, dimmest = 0.F, widest = 0.F;
  int wide = 0;
  for (std::uint64_t i = 0; i < 400; ++i) {
    const VariedSensor drawn = draw_sensor(options, preset, Random(5, i));
    const float dim = drawn.sensor.min_infrared / preset.min_infrared;
    brightest = std::min(brightest, dim);
    dimmest = std::max(dimmest, dim);
    EXPECT_LE(drawn.sensor.mixed_px, 4.F * preset.mixed_px);
    EXPECT_GE(drawn.sensor.mixed_px, preset.mixed_px);
    EXPECT_LE(drawn.stray_light, 0.1F);
    widest = std::max(widest, std::abs(drawn.true_focal_share - 1.F));
    EXPECT_LE(drawn.sensor.border_high.left, 64);
    EXPECT_EQ(drawn.sensor.border_high.left, drawn.sensor.border_low.left);
    wide += drawn.sensor.border_high.top > 0 ? 1 : 0;
  }
  EXPECT_LT(brightest, 1.1F);
  EXPECT_GT(dimmest, 9.F);
  EXPECT_LE(dimmest, 10.F);
  EXPECT_GT(widest, 0.045F);
  EXPECT_LE(widest, 0.05F);
  EXPECT_NEAR(wide, 200, 40);
}

TEST(SensorVariety, OneOptionLeavesWhatTheOthersDraw) {
  SensorVariety one, both;
  one.focal_error = both.focal_error = 0.05F;
  both.matching_max = both.dim_max = 5.F;
  both.border_max = 0.1F;
  const Sensor& preset = find_sensor("d435");
  EXPECT_EQ(draw_sensor(one, preset, Random(1, 7)).true_focal_share,
            draw_sensor(both, preset, Random(1, 7)).true_focal_share);
}

}  // namespace
}  // namespace vesalius::synth
