#include "dataset/tum_trajectory.h"

#include <numbers>

#include "io/files/test_files.h"

namespace vesalius {
namespace {

using ::testing::HasSubstr;

TEST(Trajectory, InterpolatesBetweenPoses) {
  // The camera moves one metre to the right from the origin and turns a quarter about its y axis.
  const Trajectory trajectory = Trajectory::parse(
      "# ground truth trajectory\n# timestamp tx ty tz qx qy qz qw\n\n"
      "10.00 0 0 0 0 0 0 1\r\n10.10 1 0 2 0 0.70710678 0 0.70710678\n",
      "t");
  const auto middle = trajectory.world_from_camera(10.05);
  ASSERT_TRUE(middle);
  EXPECT_TRUE(middle->translation().isApprox(Eigen::Vector3d(0.5, 0, 1), 1e-9));
  const Eigen::AngleAxisd turn(middle->rotation());
  EXPECT_NEAR(turn.angle(), std::numbers::pi / 4, 1e-6);
  // After an eighth of a turn about y the camera looks between the world's z and x.
  EXPECT_TRUE((middle->rotation() * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d(1, 0, 1).normalized(), 1e-6));
  EXPECT_TRUE(trajectory.world_from_camera(10.0)->isApprox(Eigen::Isometry3d::Identity()));
  EXPECT_TRUE(trajectory.world_from_camera(10.1)->translation().isApprox(Eigen::Vector3d(1, 0, 2)));
}

TEST(Trajectory, HasNoPoseOutsideTheRecordingAndInGaps) {
  const Trajectory trajectory = Trajectory::parse("1 0 0 0 0 0 0 1\n1.2 0 0 0 0 0 0 1\n", "t");
  for (const double time_s : {0.99, 1.1, 1.21}) EXPECT_FALSE(trajectory.world_from_camera(time_s)) << time_s;
  EXPECT_TRUE(trajectory.world_from_camera(1.2));
}

TEST(Trajectory, DistinguishesAMovingCameraFromAStillOne) {
  const auto motion = [](const std::string& later) {
    return Trajectory::parse("0 0 0 0 0 0 0 1\n0.1 " + later + "\n", "t").motion(0.05);
  };
  EXPECT_EQ(motion("0.004 0 0 0 0 0 1"), CameraMotion::still);    // 0.04 m/s
  EXPECT_EQ(motion("0 0.006 0 0 0 0 1"), CameraMotion::moving);   // 0.06 m/s
  EXPECT_EQ(motion("0 0 0 0 0 0.0039 1"), CameraMotion::still);   // 4.5 degrees/s
  EXPECT_EQ(motion("0 0 0 0 0.0048 0 1"), CameraMotion::moving);  // 5.5 degrees/s
  EXPECT_EQ(Trajectory::parse("0 0 0 0 0 0 0 1\n", "t").motion(0.0), CameraMotion::unknown);
}

TEST(Trajectory, NamesTheLineOfErrors) {
  const auto error = [](const std::string& text) { return test::error_of([&] { Trajectory::parse(text, "g.txt"); }); };
  EXPECT_THAT(error("# nothing\n"), HasSubstr("g.txt: no pose"));
  for (const char* line : {"1 2 3", "1 0 0 0 0 0 0 1 9", "1 0 0 0 0 0 0 x", "1 0 0 0 0 0 0 1x", "nan 0 0 0 0 0 0 1"}) {
    EXPECT_EQ(error("# c\n" + std::string(line)), "g.txt:2: expected \"timestamp tx ty tz qx qy qz qw\"");
  }
  EXPECT_THAT(error("1 0 0 0 0 0 0 0\n"), HasSubstr("g.txt:1: a quaternion of length 0, expected 1"));
  EXPECT_THAT(error("2 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n"), HasSubstr("g.txt:2: a time that does not come after"));
}

}  // namespace
}  // namespace vesalius
