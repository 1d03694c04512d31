#include "cli/ros2/ros2_flags.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "vesalius/error.h"

namespace vesalius::cli {
namespace {

using Eigen::Vector3d;

TEST(CameraPose, TurnsACameraThatLooksAlongX) {
  const auto pose = parse_camera_pose("base_link,0.5,0,1.2,0,0,0");
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->parent, "base_link");
  // What is two metres before the camera, half a metre to its right and below it.
  EXPECT_TRUE((pose->parent_from_optical * Vector3d(0.5, 0.25, 2)).isApprox(Vector3d(2.5, -0.5, 0.95), 1e-12));
  const auto down = parse_camera_pose("map,0,0,1,0," + std::to_string(std::numbers::pi / 2) + ",0");
  EXPECT_TRUE((down->parent_from_optical * Vector3d(0, 0, 1)).isMuchSmallerThan(1.0, 1e-5)) << "pitch looks down";
  const auto left = parse_camera_pose("map,0,0,0,0,0," + std::to_string(std::numbers::pi / 2));
  EXPECT_TRUE((left->parent_from_optical * Vector3d(0, 0, 1)).isApprox(Vector3d(0, 1, 0), 1e-5)) << "yaw turns left";
  EXPECT_FALSE(parse_camera_pose(""));
}

TEST(CameraPose, RefusesOtherTexts) {
  for (const char* text : {"base", ",1,2,3,4,5,6", "b,1,2,3,4,5", "b,1,2,3,4,5,6,7", "b,1,2,3,4,5,x", "b,1,2,3,4,5,nan",
                           "b,1,2,3,4,5,inf", "b,1,,3,4,5,6", "b;1;2;3;4;5;6"}) {
    EXPECT_THROW(parse_camera_pose(text), UsageError) << text;
  }
}

TEST(Ros2Flags, HearTheEnvironment) {
  ::setenv("ROS_DISTRO", "humble", 1);
  ::setenv("ROS_LOCALHOST_ONLY", "1", 1);
  EXPECT_EQ(node_options({}).gid_bytes, ros2::kOldGidBytes);
  EXPECT_TRUE(node_options({}).localhost);
  Ros2Flags flags;
  flags.distribution = "jazzy";
  EXPECT_EQ(node_options(flags).gid_bytes, ros2::kGidBytes) << "the flag counts";
  ::setenv("ROS_DISTRO", "newer", 1);
  ::setenv("ROS_LOCALHOST_ONLY", "0", 1);
  EXPECT_EQ(node_options({}).gid_bytes, ros2::kGidBytes);
  EXPECT_FALSE(node_options({}).localhost);
  ::setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST", 1);
  EXPECT_TRUE(node_options({}).localhost);
  for (const char* name : {"ROS_DISTRO", "ROS_LOCALHOST_ONLY", "ROS_AUTOMATIC_DISCOVERY_RANGE"}) ::unsetenv(name);
}

TEST(Ros2Flags, ResolveNames) {
  Ros2Flags flags;
  flags.name_space = "/robot";
  flags.node = "eye";
  flags.remaps = {"/tf:=tf", "~/points:=/cloud"};
  const auto remap = topic_options(flags).remap;
  EXPECT_EQ(remap.at("/tf"), "/robot/tf");
  EXPECT_EQ(remap.at("/robot/eye/points"), "/cloud");
  flags.subscribe = "/camera";
  SourceOptions camera;
  camera.depth_topic = "depth/image";
  EXPECT_EQ(subscribe_options(flags, camera).topics.depth, "/robot/depth/image");
  EXPECT_EQ(subscribe_options(flags, camera).topics.colour, "");
  camera.depth_scale = 5000.F;
  EXPECT_EQ(subscribe_options(flags, camera).stored.depth_scale, 5000.F);
  camera.fx = 500.F;
  EXPECT_THROW(subscribe_options(flags, camera), UsageError) << "camera_info has it";
  camera.fx.reset();
  camera.depth_topic = "depth image";
  EXPECT_THROW(subscribe_options(flags, camera), UsageError);
  flags.remaps = {"/tf=/tf2"};
  EXPECT_THROW(topic_options(flags), UsageError);
}

}  // namespace
}  // namespace vesalius::cli
