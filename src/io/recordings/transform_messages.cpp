#include "io/recordings/transform_messages.h"

#include <algorithm>
#include <cmath>

#include "io/recordings/camera_topics.h"
#include "io/recordings/foxglove_messages.h"
#include "io/recordings/message_fields.h"

namespace vesalius {
namespace {

/// More frames above each other than any robot has.
constexpr std::size_t kMostAncestors = 1000;

bool is_realsense(const RecordedTopic& topic) {
  const std::string stream = realsense_stream(topic.name);
  return !stream.empty() && topic.name.starts_with(stream + "/tf/") &&
         (topic.type == "geometry_msgs/Transform" || topic.type == "std_msgs/String");
}

/// Returns nothing unless the numbers are a translation and a rotation.
std::optional<Eigen::Isometry3d> isometry(const Eigen::Vector3d& translation, const Eigen::Quaterniond& rotation) {
  constexpr double kOff = 0.05;
  if (!translation.allFinite() || !(std::abs(rotation.norm() - 1.0) < kOff)) return std::nullopt;
  return Eigen::Translation3d(translation) * rotation.normalized();
}

/// geometry_msgs/Transform
std::optional<Eigen::Isometry3d> read_transform(MessageFields& fields) {
  const std::vector<double> t = fields.reals64(3, "the translation");
  const std::vector<double> q = fields.reals64(4, "the rotation");
  return isometry({t[0], t[1], t[2]}, {q[3], q[0], q[1], q[2]});
}

/// librealsense 2.56 and later: "rotation=...;translation=...", the matrix column by column.
std::optional<Eigen::Isometry3d> read_realsense_text(std::string_view text) {
  const std::vector<double> r = realsense_numbers(realsense_value(text, "rotation"));
  const std::vector<double> t = realsense_numbers(realsense_value(text, "translation"));
  if (r.size() != 9 || t.size() != 3) return std::nullopt;
  const Eigen::Map<const Eigen::Matrix3d> matrix(r.data());
  if (!matrix.allFinite() || !matrix.isUnitary(1e-2) || matrix.determinant() < 0.0) return std::nullopt;
  return isometry({t[0], t[1], t[2]}, Eigen::Quaterniond(matrix));
}

/// A stream of a RealSense camera, in the frame of the stream that its group refers to. What is recorded takes points
/// of that one to this.
std::vector<FrameTransform> parse_realsense(const RecordedTopic& topic, std::string_view message,
                                            const std::string& name) {
  const std::string stream = realsense_stream(topic.name);
  MessageFields fields(message, topic.layout, name);
  const std::optional<Eigen::Isometry3d> stream_from_reference =
      topic.type == "std_msgs/String" ? read_realsense_text(fields.text("the extrinsics")) : read_transform(fields);
  if (!stream_from_reference) return {};
  const std::string device = stream.substr(0, stream.find('/', 1));
  return {{device + topic.name.substr(stream.size()), stream, stream_from_reference->inverse()}};
}

bool is_orbbec(const RecordedTopic& topic) {
  return topic.name == "/cam/streamProfileType_3" && topic.type.ends_with("StreamProfileInfo");
}

/// The stream of depth of Orbbec's recordings: what takes its points to those of colour, row by row, millimetres.
std::vector<FrameTransform> parse_orbbec(const RecordedTopic& topic, std::string_view message,
                                         const std::string& name) {
  MessageFields fields(message, topic.layout, name);
  std::string frame;
  fields.header(frame);
  fields.u8("the kind of stream");
  fields.u8("the format");
  Eigen::Matrix3d rotation;
  for (int i = 0; i < 9; ++i) rotation(i / 3, i % 3) = double(fields.real32("the rotation"));
  Eigen::Vector3d translation_mm;
  for (double& t : translation_mm) t = double(fields.real32("the translation"));
  if (!rotation.allFinite() || !rotation.isUnitary(1e-2) || rotation.determinant() < 0.0) return {};
  const auto colour_from_depth = isometry(translation_mm / 1e3, Eigen::Quaterniond(rotation));
  if (!colour_from_depth) return {};
  return {{orbbec_frame(kOrbbecColour), orbbec_frame(kOrbbecDepth), *colour_from_depth}};
}

bool is_of_ros(const RecordedTopic& topic) {
  return topic.type == "tf2_msgs/TFMessage" || topic.type == "tf/tfMessage";  // the second is older
}

bool is_of_foxglove(const RecordedTopic& topic) {
  return is_foxglove(topic, "FrameTransform") || is_foxglove(topic, "FrameTransforms");
}

std::vector<FrameTransform> parse_foxglove(const RecordedTopic& topic, std::string_view message,
                                           const std::string& name) {
  std::vector<FrameTransform> transforms;
  for (const FoxgloveMessage& one : read_foxglove(topic, message, name)) {
    const std::vector<double>&t = one.reals("translation"), &q = one.reals("rotation");
    if (const auto found = isometry({t[0], t[1], t[2]}, {q[3], q[0], q[1], q[2]})) {
      transforms.push_back({plain_frame(one.text("parent_frame_id")), plain_frame(one.text("child_frame_id")), *found});
    }
  }
  return transforms;
}

}  // namespace

bool is_transform(const RecordedTopic& topic) {
  if (is_of_foxglove(topic)) return true;
  if (!is_ros(topic)) return false;
  return is_of_ros(topic) || is_realsense(topic) || is_orbbec(topic);
}

std::vector<FrameTransform> parse_transforms(const RecordedTopic& topic, std::string_view message,
                                             const std::string& name) {
  std::vector<FrameTransform> transforms;
  if (is_of_foxglove(topic)) {
    transforms = parse_foxglove(topic, message, name);
  } else if (is_realsense(topic)) {
    transforms = parse_realsense(topic, message, name);
  } else if (is_orbbec(topic)) {
    transforms = parse_orbbec(topic, message, name);
  } else {
    MessageFields fields(message, topic.layout, name);
    const std::uint32_t count = fields.u32("the number of transforms");
    for (std::uint32_t i = 0; i < count; ++i) {
      std::string parent;
      fields.header(parent);
      const std::string child = plain_frame(fields.text("the child's frame"));
      if (const auto found = read_transform(fields)) transforms.push_back({plain_frame(parent), child, *found});
    }
  }
  // Drivers of ROS 1 repeat in /tf where their cameras stand.
  const bool may_move = (is_of_ros(topic) || is_of_foxglove(topic)) && !topic.name.ends_with("tf_static");
  for (FrameTransform& one : transforms) one.may_move = may_move;
  return transforms;
}

std::string transforms_message(const std::vector<FrameTransform>& transforms, std::int64_t time_ns) {
  CdrWriter out;
  out.u32(static_cast<std::uint32_t>(transforms.size()));
  for (const FrameTransform& one : transforms) {
    out.header(time_ns, one.parent);
    out.text(one.child);
    for (const double t : one.parent_from_child.translation()) out.real64(t);
    const Eigen::Quaterniond q(one.parent_from_child.linear());
    for (const double k : {q.x(), q.y(), q.z(), q.w()}) out.real64(k);
  }
  return out.message();
}

void TransformTree::add(const FrameTransform& transform) {
  constexpr double kSame = 1e-6;
  if (transform.may_move && moving_.contains(transform.child)) return;
  const auto [known, is_new] = parents_.try_emplace(transform.child, transform);
  if (is_new || !known->second.may_move) return;
  if (!transform.may_move) {
    known->second = transform;
  } else if (known->second.parent != transform.parent ||
             !known->second.parent_from_child.isApprox(transform.parent_from_child, kSame)) {
    moving_.insert(transform.child);
    parents_.erase(known);
  }
}

std::vector<std::pair<std::string, Eigen::Isometry3d>> TransformTree::chain(const std::string& frame) const {
  std::vector<std::pair<std::string, Eigen::Isometry3d>> up{{plain_frame(frame), Eigen::Isometry3d::Identity()}};
  while (up.size() < kMostAncestors) {
    const auto found = parents_.find(up.back().first);
    if (found == parents_.end()) break;
    up.emplace_back(found->second.parent, found->second.parent_from_child * up.back().second);
  }
  return up;
}

std::optional<Eigen::Isometry3d> TransformTree::find(const std::string& to, const std::string& from) const {
  if (to.empty() || from.empty()) return std::nullopt;
  const auto above_to = chain(to), above_from = chain(from);
  for (const auto& ancestor : above_from) {
    const auto common = std::ranges::find(above_to, ancestor.first, &std::pair<std::string, Eigen::Isometry3d>::first);
    if (common != above_to.end()) return common->second.inverse() * ancestor.second;
  }
  return std::nullopt;
}

}  // namespace vesalius
