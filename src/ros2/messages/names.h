#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace vesalius::ros2 {

/// Throws UsageError naming `what` unless `name` is a node's name: letters, digits and underscores, no digit first.
void check_node_name(std::string_view name, std::string_view what);

/// Throws UsageError naming `what` unless `name` is a full topic name or namespace such as "/camera/depth"; "/" is one
/// where `root` says so.
void check_full_name(std::string_view name, std::string_view what, bool root = false);

/// Returns the full name of a topic as ROS 2 finds it: "/x" is itself, "x" is in the namespace, "~/x" under the node.
/// Throws UsageError naming `what` if that is no name of a topic.
std::string resolve_name(std::string_view topic, std::string_view name_space, std::string_view node,
                         std::string_view what);

/// Returns a topic's name on the wire: "/tf" becomes "rt/tf".
std::string topic_on_wire(std::string_view full_name);

/// Returns a type's name on the wire: "sensor_msgs/Image" becomes "sensor_msgs::msg::dds_::Image_".
std::string type_on_wire(std::string_view type);

/// A topic and what it carries.
struct TopicType {
  std::string name;  ///< "/camera/depth/image_raw"
  std::string type;  ///< "sensor_msgs/Image"

  friend bool operator==(const TopicType&, const TopicType&) = default;
};

/// Returns what names on the wire stand for; nothing if they are not those of a topic of ROS 2.
std::optional<TopicType> topic_from_wire(std::string_view topic, std::string_view type);

/// Returns a type's name in ROS 2: "sensor_msgs/Image" becomes "sensor_msgs/msg/Image".
std::string long_type(std::string_view type);

}  // namespace vesalius::ros2
