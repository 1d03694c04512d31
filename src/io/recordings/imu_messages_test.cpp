#include "io/recordings/imu_messages.h"

#include <gmock/gmock.h>

#include "io/files/test_files.h"

namespace vesalius {
namespace {

TEST(ImuMessages, GiveBackUp) {
  const Eigen::Vector3f up = Eigen::Vector3f(0.1F, -0.9F, 0.3F).normalized();
  const std::string message = imu_message(up, 1'500'000'001, "camera");
  const RecordedTopic topic{"/imu", "sensor_msgs/Imu", MessageLayout::cdr, 1};
  const Acceleration read = parse_acceleration(topic, message, "here");
  EXPECT_EQ(read.time_ns, 1'500'000'001);
  EXPECT_EQ(read.frame, "camera");
  EXPECT_NEAR(read.m_s2.norm(), 9.80665, 1e-5);
  EXPECT_LT((read.m_s2.normalized().cast<float>() - up).norm(), 2e-7F);
  EXPECT_EQ(parse_acceleration(topic, imu_message({}, 1, "camera"), "here").m_s2, Eigen::Vector3d(0, 0, 0));
  EXPECT_THAT(test::error_of([&] { parse_acceleration(topic, message.substr(0, 200), "here"); }),
              testing::HasSubstr("here: a message ends within"));
}

TEST(ImuMessages, OfRealSenseAreThoseOfTheAccelerometer) {
  const auto is = [](const char* name) { return is_acceleration({name, "sensor_msgs/Imu", MessageLayout::ros1, 1}); };
  EXPECT_TRUE(is("/device_0/sensor_2/Accel_0/imu/data"));
  EXPECT_FALSE(is("/device_0/sensor_2/Gyro_0/imu/data"));
  EXPECT_TRUE(is("/imu/data"));
}

}  // namespace
}  // namespace vesalius
