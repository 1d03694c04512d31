#include "io/sensors/live_source.h"

#include <gmock/gmock.h>

#include <limits>

#include "io/sensors/sensor.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using testing::HasSubstr;

TEST(LiveSource, AtRestAccelerationPointsUp) {
  const auto up = up_of({0.F, -9.6F, 0.F});
  ASSERT_TRUE(up);
  EXPECT_EQ(*up, Eigen::Vector3f(0.F, -1.F, 0.F));
  const auto tilted = up_of({0.F, -7.F, -7.F});
  ASSERT_TRUE(tilted);
  EXPECT_NEAR(tilted->norm(), 1.F, 1e-6F);
  EXPECT_NEAR(tilted->y(), tilted->z(), 1e-6F);
}

TEST(LiveSource, AMovedCameraDoesNotKnowUp) {
  EXPECT_FALSE(up_of({0.F, 0.F, 0.F}));
  EXPECT_FALSE(up_of({0.F, -1.F, 0.F}));  // in units of gravity
  EXPECT_FALSE(up_of({3.F, -12.F, 0.F}));
  EXPECT_FALSE(up_of({std::numeric_limits<float>::quiet_NaN(), -9.8F, 0.F}));
}

/// Returns what expect_plugged_in throws; empty if it does not.
std::string refusal(const std::vector<SensorInfo>& cameras, const std::string& id) {
  try {
    expect_plugged_in("kinect", cameras, id);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

TEST(Sensor, IsNamedOrTheOnlyOne) {
  const std::vector<SensorInfo> two{{"a", "A"}, {"b", "B"}};
  EXPECT_EQ(refusal(two, "b"), "");
  EXPECT_EQ(refusal({{"a", "A"}}, ""), "");
  EXPECT_EQ(refusal(two, ""), "kinect: 2 cameras, expected one of kinect:a, kinect:b");
  EXPECT_EQ(refusal(two, "c"), "kinect:c: no such camera, expected one of kinect:a, kinect:b");
  EXPECT_EQ(refusal({}, "c"), "kinect:c: no camera is plugged in, expected one that `vesalius cameras` lists");
}

TEST(Sensor, ThatIsInUseSaysWhatToDo) {
  try {
    fail_to_open(source_of("kinect", "a"), "Device or resource busy");
    FAIL();
  } catch (const Error& e) {
    EXPECT_THAT(e.what(), HasSubstr("kinect:a cannot be opened: Device or resource busy; end any other program"));
  }
}

}  // namespace
}  // namespace vesalius
