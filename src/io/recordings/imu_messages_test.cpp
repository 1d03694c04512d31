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

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::int64_t kMs = 1'000'000;

TEST(UpHistory, IsTheDirectionOfTheMeanOfHalfASecond) {
  UpHistory history;
  EXPECT_FALSE(history.up_at(0));
  history.add(0, {9.8, 0, 0});  // too old for the frame at 600 ms
  for (int i = 0; i < 50; ++i) history.add((200 + 5 * i) * kMs, {0.0, -9.8, i % 2 == 0 ? 1.0 : -1.0});
  history.add(700 * kMs, {9.8, 0, 0});  // later than the frame
  EXPECT_LT((history.up_at(600 * kMs).value() - Vector3f(0, -1, 0)).norm(), 1e-6F);
  EXPECT_FALSE(history.up_at(1300 * kMs)) << "the last measurement is older";
}

TEST(UpHistory, KnowsNothingOfACameraThatMoves) {
  for (const double length : {0.0, 9.2, 9.4, 10.2, 10.4}) {
    UpHistory history;
    history.add(0, {0, -length, 0});
    EXPECT_EQ(history.up_at(kMs).has_value(), length > 9.3 && length < 10.3) << length;
  }
}

TEST(UpHistory, TakesWhatWasMeasuredForTheFrameAlone) {
  UpHistory history;
  history.add(990 * kMs, {9.8, 0, 0});
  history.add(1000 * kMs, {0, 0, 9.8});
  EXPECT_EQ(history.up_at(1000 * kMs), Vector3f(0, 0, 1));
  history.clear();
  EXPECT_FALSE(history.up_at(1000 * kMs));
}

}  // namespace

}  // namespace vesalius
