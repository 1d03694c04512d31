#include "ros2/messages/names.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "vesalius/error.h"

namespace vesalius::ros2 {
namespace {

/// DDS has 256 characters for a topic, of which ROS 2 keeps some.
constexpr std::size_t kLongest = 247;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool is_token(std::string_view token) {
  const auto fits = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || is_digit(c) || c == '_'; };
  return !token.empty() && !is_digit(token.front()) && std::ranges::all_of(token, fits);
}

bool is_full_name(std::string_view name) {
  if (!name.starts_with('/') || name.size() > kLongest) return false;
  while (!name.empty()) {
    name.remove_prefix(1);
    const std::size_t length = std::min(name.find('/'), name.size());
    if (!is_token(name.substr(0, length))) return false;
    name.remove_prefix(length);
  }
  return true;
}

/// "sensor_msgs" and "Image".
std::pair<std::string_view, std::string_view> split(std::string_view type) {
  const std::size_t slash = type.find('/');
  return {type.substr(0, slash), type.substr(slash + 1)};
}

}  // namespace

void check_node_name(std::string_view name, std::string_view what) {
  if (is_token(name) && name.size() <= kLongest) return;
  throw UsageError(
      fmt::format("{} {}: expected letters, digits and underscores, not beginning with a digit", what, name));
}

void check_full_name(std::string_view name, std::string_view what, bool root) {
  if (is_full_name(name) || (root && name == "/")) return;
  throw UsageError(fmt::format(
      "{} {}: expected a name such as /robot/camera: a slash before each word of letters, digits and underscores that "
      "begins with no digit",
      what, name));
}

std::string resolve_name(std::string_view topic, std::string_view name_space, std::string_view node,
                         std::string_view what) {
  const std::string before = name_space == "/" ? "" : std::string(name_space);
  std::string full(topic);
  if (topic.starts_with("~/")) {
    full = fmt::format("{}/{}{}", before, node, topic.substr(1));
  } else if (!topic.starts_with('/')) {
    full = fmt::format("{}/{}", before, topic);
  }
  check_full_name(full, what);
  return full;
}

std::string topic_on_wire(std::string_view full_name) { return fmt::format("rt{}", full_name); }

std::string type_on_wire(std::string_view type) {
  const auto [package, name] = split(type);
  return fmt::format("{}::msg::dds_::{}_", package, name);
}

std::optional<TopicType> topic_from_wire(std::string_view topic, std::string_view type) {
  constexpr std::string_view kBefore = "rt", kBetween = "::msg::dds_::";
  const std::size_t between = type.find(kBetween);
  if (!topic.starts_with(kBefore) || between == type.npos || !type.ends_with('_')) return std::nullopt;
  topic.remove_prefix(kBefore.size());
  type.remove_suffix(1);
  if (!is_full_name(topic) || between + kBetween.size() > type.size()) return std::nullopt;
  return TopicType{std::string(topic),
                   fmt::format("{}/{}", type.substr(0, between), type.substr(between + kBetween.size()))};
}

std::string long_type(std::string_view type) {
  const auto [package, name] = split(type);
  return fmt::format("{}/msg/{}", package, name);
}

}  // namespace vesalius::ros2
