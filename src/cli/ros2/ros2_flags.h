#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "ros2/dds/node.h"
#include "ros2/dds/topic_source.h"
#include "ros2/messages/people_topics.h"
#include "vesalius/frame_source.h"

namespace CLI {
class App;
}

namespace vesalius::cli {

/// The flags of `vesalius ros2` that are ROS 2's.
struct Ros2Flags {
  std::string name_space = "/", node = "vesalius", distribution, id_prefix = "p", frame_id;
  std::string subscribe, camera_info_topic, camera_pose, stamps;
  std::vector<std::string> remaps;
  int domain = 0;
  bool localhost = false, reliable = false, whole_cloud = false;
};

void add_ros2_flags(CLI::App& command, Ros2Flags& flags);

/// Returns the node's options, with what ROS_DISTRO, ROS_LOCALHOST_ONLY and ROS_AUTOMATIC_DISCOVERY_RANGE say.
ros2::NodeOptions node_options(const Ros2Flags& flags);
/// Throws UsageError for names that are none.
ros2::PeopleTopicsOptions topic_options(const Ros2Flags& flags);
/// The topics that `camera` names are resolved below the node's namespace. Throws UsageError for names that are none.
ros2::TopicSourceOptions subscribe_options(const Ros2Flags& flags, const SourceOptions& camera);

/// Where the camera stands in another coordinate frame.
struct CameraPose {
  std::string parent;
  Eigen::Isometry3d parent_from_optical;
};

/// Returns the pose that "base_link,0.1,0,1.2,0,0.3,0" states: x, y, z in metres, roll, pitch and yaw in radians, of a
/// camera that looks along x with z up; nothing for an empty text. Throws UsageError for another one.
std::optional<CameraPose> parse_camera_pose(const std::string& text);

}  // namespace vesalius::cli
