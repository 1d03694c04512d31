#include "cli/ros2/ros2_flags.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <set>

#include "ros2/messages/names.h"
#include "vesalius/error.h"

namespace vesalius::cli {
namespace {

/// Distributions whose gids have 24 bytes.
const std::set<std::string> kOldDistributions = {"foxy", "galactic", "humble"};
const std::set<std::string> kDistributions = {"foxy",  "galactic", "humble",  "iron",
                                              "jazzy", "kilted",   "lyrical", "rolling"};

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::map<std::string, std::string> parse_remaps(const Ros2Flags& flags) {
  constexpr std::string_view kBetween = ":=";
  std::map<std::string, std::string> remaps;
  for (const std::string& text : flags.remaps) {
    const std::size_t between = text.find(kBetween);
    if (between == text.npos) throw UsageError(fmt::format("--remap {}: expected FROM:=TO", text));
    const auto full = [&](const std::string& name) {
      return ros2::resolve_name(name, flags.name_space, flags.node, "--remap");
    };
    remaps[full(text.substr(0, between))] = full(text.substr(between + kBetween.size()));
  }
  return remaps;
}

}  // namespace

void add_ros2_flags(CLI::App& command, Ros2Flags& flags) {
  std::string group = "Node";
  const auto add = [&](const char* name, auto& value, const char* type, const char* help) {
    return command.add_option(name, value, help)->type_name(type)->group(group);
  };
  add("--node", flags.node, "NAME", "Name of the node")->capture_default_str();
  add("--namespace", flags.name_space, "NAME", "Namespace of the node")->capture_default_str();
  add("--domain", flags.domain, "N", "Domain of ROS 2 (default: ROS_DOMAIN_ID, otherwise 0)")
      ->check(CLI::Range(0, ros2::kMostDomain))
      ->envname("ROS_DOMAIN_ID");
  command.add_flag("--localhost", flags.localhost, "Speak to this machine alone, as ROS_LOCALHOST_ONLY=1")
      ->group(group);
  add("--ros-distro", flags.distribution, "NAME",
      "Distribution of the others (default: ROS_DISTRO, otherwise jazzy): up to humble, `ros2 node list` wants to be "
      "told otherwise than after it")
      ->check(CLI::IsMember(kDistributions));
  add("--remap", flags.remaps, "FROM:=TO", "Publish under another name, e.g. /tf:=/robot/tf; as often as needed")
      ->allow_extra_args(false);
  group = "Topics";
  add("--frame-id", flags.frame_id, "NAME",
      "Coordinate frame of the pictures, optical (default: camera_optical_frame, or as subscribed pictures say)");
  add("--camera-pose", flags.camera_pose, "FRAME,X,Y,Z,ROLL,PITCH,YAW",
      "Publish in /tf_static where the camera stands: metres and radians, of a camera that looks along x");
  add("--stamps", flags.stamps, "WHAT",
      "Times of messages: now (default), those at which frames are played, of a camera those of arrival; or frame, the "
      "frames' own (default with --every-frame)")
      ->check(CLI::IsMember({"frame", "now"}));
  add("--id-prefix", flags.id_prefix, "TEXT", "Before the number in the names of bodies")->capture_default_str();
  command.add_flag("--whole-cloud", flags.whole_cloud, "All pixels in ~/points, not those of people alone")
      ->group(group);
  group = "Frames from topics";
  add("--subscribe", flags.subscribe, "NAMESPACE",
      "Take frames from the topics of a camera's driver below this namespace instead of SOURCE; --depth-topic and "
      "--colour-topic name others");
  add("--camera-info-topic", flags.camera_info_topic, "TOPIC",
      "Topic of the calibration (default: camera_info beside depth)");
  command.add_flag("--reliable", flags.reliable, "Ask again for pictures that get lost; the driver must be reliable")
      ->group(group);
}

ros2::NodeOptions node_options(const Ros2Flags& flags) {
  ros2::NodeOptions options;
  options.name = flags.node;
  options.name_space = flags.name_space;
  options.domain = flags.domain;
  options.localhost = flags.localhost || environment("ROS_LOCALHOST_ONLY") == "1" ||
                      environment("ROS_AUTOMATIC_DISCOVERY_RANGE") == "LOCALHOST";
  const std::string distribution = flags.distribution.empty() ? environment("ROS_DISTRO") : flags.distribution;
  if (kOldDistributions.contains(distribution)) options.gid_bytes = ros2::kOldGidBytes;
  return options;
}

ros2::PeopleTopicsOptions topic_options(const Ros2Flags& flags) {
  ros2::PeopleTopicsOptions options;
  options.name_space = flags.name_space;
  options.node = flags.node;
  options.id_prefix = flags.id_prefix;
  options.cloud = flags.whole_cloud ? ros2::CloudExtent::frame : ros2::CloudExtent::people;
  options.frames = flags.subscribe.empty();
  options.remap = parse_remaps(flags);
  return options;
}

ros2::TopicSourceOptions subscribe_options(const Ros2Flags& flags, const SourceOptions& camera) {
  if (camera.fx || camera.fy || camera.cx || camera.cy || !camera.camera_file.empty() || !camera.colour_file.empty()) {
    throw UsageError("--subscribe: camera_info is the calibration; --fx, --camera and --colour go with a SOURCE only");
  }
  const auto full = [&](const std::string& topic, const char* what) {
    return topic.empty() ? "" : ros2::resolve_name(topic, flags.name_space, flags.node, what);
  };
  ros2::TopicSourceOptions options;
  options.name_space = flags.subscribe;
  ros2::check_full_name(flags.subscribe, "--subscribe", true);
  options.topics.depth = full(camera.depth_topic, "--depth-topic");
  options.topics.colour = full(camera.colour_topic, "--colour-topic");
  options.topics.camera_info = full(flags.camera_info_topic, "--camera-info-topic");
  options.reliable = flags.reliable;
  options.stored.depth_scale = camera.depth_scale;
  options.stored.depth_bits = camera.depth_bits;
  return options;
}

std::optional<CameraPose> parse_camera_pose(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const auto refusal = [&] {
    return UsageError(fmt::format(
        "--camera-pose {}: expected FRAME,X,Y,Z,ROLL,PITCH,YAW in metres and radians, e.g. base_link,0.1,0,1.2,0,0,0",
        text));
  };
  std::size_t at = text.find(',');
  if (at == 0 || at == text.npos) throw refusal();
  std::array<double, 6> numbers{};
  const char* from = text.data() + at;
  const char* end = text.data() + text.size();
  for (double& number : numbers) {
    if (from == end || *from != ',') throw refusal();
    const auto [stop, error] = std::from_chars(from + 1, end, number);
    if (error != std::errc() || !std::isfinite(number)) throw refusal();
    from = stop;
  }
  if (from != end) throw refusal();
  const auto [x, y, z, roll, pitch, yaw] = numbers;
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  Eigen::Matrix3d camera_from_optical;
  camera_from_optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Vector3d(x, y, z);
  pose.linear() =
      (AngleAxisd(yaw, Vector3d::UnitZ()) * AngleAxisd(pitch, Vector3d::UnitY()) * AngleAxisd(roll, Vector3d::UnitX()))
          .toRotationMatrix() *
      camera_from_optical;
  return CameraPose{text.substr(0, at), pose};
}

}  // namespace vesalius::cli
