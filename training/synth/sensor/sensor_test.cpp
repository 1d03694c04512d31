#include "synth/sensor/sensor.h"

#include <gmock/gmock.h>

#include <set>

#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using testing::HasSubstr;

TEST(Sensors, HaveUniqueNamesAndUsableNumbers) {
  std::set<std::string> names;
  for (const Sensor& s : sensors()) {
    EXPECT_TRUE(names.insert(s.name).second) << s.name;
    EXPECT_EQ(&find_sensor(s.name), &s);
    EXPECT_NO_THROW(check(s.camera)) << s.name;
    EXPECT_LT(s.near_m, s.far_m) << s.name;
    EXPECT_GE(s.window_px, 1.F) << s.name;
    EXPECT_LE(s.border_low.left, s.border_high.left) << s.name;
    EXPECT_LE(s.border_low.right, s.border_high.right) << s.name;
    EXPECT_LE(s.border_low.top, s.border_high.top) << s.name;
    EXPECT_LE(s.border_low.bottom, s.border_high.bottom) << s.name;
    const bool triangulates = s.kind == SensorKind::structured_light || s.kind == SensorKind::stereo;
    EXPECT_EQ(s.disparity_px_m > 0.F && s.disparity_step_px > 0.F && s.baseline_m != 0.F, triangulates) << s.name;
    EXPECT_EQ(s.min_infrared > 0.F, s.kind != SensorKind::perfect) << s.name;
  }
  for (const char* name :
       {"kinect-v1", "kinect-v2", "azure-kinect", "femto-bolt", "xtion", "d435", "d455", "perfect"}) {
    EXPECT_EQ(names.count(name), 1U) << name;
  }
}

TEST(Sensors, ListTheirNamesForAnUnknownOne) {
  try {
    find_sensor("kinect-v3");
    FAIL();
  } catch (const UsageError& e) {
    EXPECT_THAT(e.what(), HasSubstr("sensor \"kinect-v3\", expected one of kinect-v1, "));
  }
}

TEST(Sensors, KeepTheirViewWhenBinned) {
  const Sensor& full = find_sensor("kinect-v1");
  const Sensor half = resized(full, 320, 240);
  EXPECT_EQ(half.camera, full.camera.resized(320, 240));
  EXPECT_FLOAT_EQ(half.lateral_px, full.lateral_px / 2.F);
  EXPECT_FLOAT_EQ(half.window_px, full.window_px / 2.F);
  EXPECT_NEAR(half.border_high.left, full.border_high.left / 2.0, 0.51);
  EXPECT_FLOAT_EQ(half.disparity_px_m, full.disparity_px_m);  // measured on the native grid
  EXPECT_FLOAT_EQ(half.disparity_step_px, full.disparity_step_px);
}

TEST(Sensors, AreCroppedAroundTheMiddleRow) {
  const Sensor cropped = resized(find_sensor("d435"), 424, 120);
  EXPECT_EQ(cropped.camera.width, 424);
  EXPECT_EQ(cropped.camera.height, 120);
  EXPECT_FLOAT_EQ(cropped.camera.fx, 212.F);
  EXPECT_FLOAT_EQ(cropped.camera.fy, 212.F);
  EXPECT_FLOAT_EQ(cropped.camera.cy, 59.5F);
  EXPECT_EQ(resized(find_sensor("kinect-v1"), 640, 400).border_high.bottom, 0);
}

TEST(Sensors, RefuseImpossibleSizes) {
  const Sensor& s = find_sensor("kinect-v1");
  EXPECT_THROW(resized(s, 8, 6), UsageError);
  EXPECT_THROW(resized(s, 320, 241), UsageError);
  EXPECT_THROW(resized(s, 320, -1), UsageError);
  EXPECT_THROW(resized(s, 1 << 20, 480), UsageError);
  EXPECT_THROW(with_camera(s, Camera{}), Error);
}

}  // namespace
}  // namespace vesalius::synth
