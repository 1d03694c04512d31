#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "io/recordings/recording.h"

namespace vesalius {

/// Where one coordinate frame stands in another.
struct FrameTransform {
  std::string parent, child;
  Eigen::Isometry3d parent_from_child = Eigen::Isometry3d::Identity();  ///< metres
  bool may_move = false;
};

/// Returns whether a topic says where coordinate frames stand: tf2_msgs/TFMessage, foxglove.FrameTransform and
/// FrameTransforms, which may move unless the topic is tf_static, and the extrinsics of RealSense and Orbbec streams.
bool is_transform(const RecordedTopic& topic);

/// Reads a message of a topic that is_transform; transforms that are none (not finite, no rotation) are left out.
/// Throws Error naming `name`.
std::vector<FrameTransform> parse_transforms(const RecordedTopic& topic, std::string_view message,
                                             const std::string& name);

/// Returns a tf2_msgs/TFMessage as CDR.
std::string transforms_message(const std::vector<FrameTransform>& transforms, std::int64_t time_ns);

/// Coordinate frames and where they stand in each other for good.
class TransformTree {
 public:
  /// The first transform of a child counts, before it those that cannot move. A child that is seen to move stands
  /// nowhere.
  void add(const FrameTransform& transform);
  /// Returns what takes points in the frame `from` to the frame `to`; nothing if nothing connects them.
  std::optional<Eigen::Isometry3d> find(const std::string& to, const std::string& from) const;

 private:
  /// Returns the frames from `frame` up, each with what takes points of `frame` to it.
  std::vector<std::pair<std::string, Eigen::Isometry3d>> chain(const std::string& frame) const;

  std::map<std::string, FrameTransform> parents_;  ///< by the child
  std::set<std::string> moving_;
};

}  // namespace vesalius
