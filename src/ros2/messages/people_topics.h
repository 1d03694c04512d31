#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "ros2/messages/cloud_message.h"
#include "ros2/messages/human_frames.h"
#include "ros2/messages/message_sink.h"
#include "vesalius/body_model.h"
#include "vesalius/camera.h"

namespace vesalius::ros2 {

/// When and where a frame was taken.
struct Stamp {
  std::int64_t time_ns = 0;  ///< since 1970 as ROS counts, or since any moment
  std::string frame;         ///< coordinate frame of the depth camera, optical: x right, y down, z forward
};

struct PeopleTopicsOptions {
  std::string name_space = "/";
  std::string node = "vesalius";
  std::string id_prefix = "p";  ///< before the number in the names of bodies, which may not begin with a digit
  CloudExtent cloud = CloudExtent::people;
  bool frames = false;  ///< whether depth and colour are published too
  /// Names to put in place of others, full ones both.
  std::map<std::string, std::string> remap = {};
};

/// Throws UsageError where names do not fit.
void check(const PeopleTopicsOptions& options);

/// Writes frames and the people in them as ROS 2 messages (docs/ros2.md has the table):
///   ~/body_index, ~/labels, ~/camera_info, ~/points, ~/markers, ~/people, /tf
///   /humans/bodies/tracked, and of each body /humans/bodies/<id>/roi and skeleton2d (REP-155)
///   ~/depth/image_rect, ~/depth/camera_info, ~/color/image_rect, ~/color/camera_info where frames are wanted
/// All of one frame have its time. Messages that the sink does not want are not made.
class PeopleTopics {
 public:
  /// Throws UsageError where names do not fit. `body` and `sink` must outlive this object.
  PeopleTopics(const BodyModel& body, PeopleTopicsOptions options, MessageSink& sink);

  /// Writes a frame and its people, without those who are lost. `json` returns its line.
  void write(const Frame& frame, const TrackedFrame& tracked, const std::function<std::string()>& json,
             const Stamp& stamp);
  /// Writes once, to /tf_static, where the camera stands.
  void write_camera_pose(const std::string& parent, const Eigen::Isometry3d& parent_from_optical, const Stamp& stamp);
  /// Writes an empty list of bodies and ends those that there were.
  void clear(const Stamp& stamp);

  /// Returns the name of a body, e.g. "p3".
  std::string id_of(int number) const { return options_.id_prefix + std::to_string(number); }

 private:
  Topic topic(std::string_view name, const char* type, bool latched = false) const;
  /// Puts what `make` returns, if it is wanted.
  template <class Make>
  void put(const Topic& topic, const Stamp& stamp, const Make& make);
  void put_calibration(std::string_view name, const Camera& camera, const Stamp& stamp);
  void write_frame(const Frame& frame, const Stamp& stamp);
  void write_pictures(const Frame& frame, const TrackedFrame& people, const Stamp& stamp);
  void write_transforms(const TrackedFrame& people, const Stamp& stamp);
  void write_bodies(const Frame& frame, const TrackedFrame& people, const Stamp& stamp);
  void write_ids(const std::vector<std::string>& ids, const Stamp& stamp);
  void end_bodies_but(const std::set<std::string>& ids);

  const BodyModel& body_;
  NamedJoints joints_;
  PeopleTopicsOptions options_;
  MessageSink& sink_;
  std::set<std::string> bodies_;  ///< that have topics
};

/// Returns a hri_msgs/IdsList as CDR.
std::string ids_message(const std::vector<std::string>& ids, std::int64_t time_ns, std::string_view frame);

/// Returns a hri_msgs/NormalizedRegionOfInterest2D as CDR: the box around the person's pixels in parts of the picture,
/// and the score. Nothing for somebody without pixels, who is hidden.
std::optional<std::string> region_message(const TrackedPerson& person, const Camera& camera, std::int64_t time_ns,
                                          std::string_view frame);

/// Returns a hri_msgs/Skeleton2D as CDR: 18 joints in OpenPose's order, in parts of the picture, with their
/// confidences. All three numbers of a joint are 0 where it has no place in the picture.
std::string skeleton_message(const TrackedPerson& person, const NamedJoints& joints, const Camera& camera,
                             std::int64_t time_ns, std::string_view frame);

}  // namespace vesalius::ros2
