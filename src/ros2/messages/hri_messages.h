#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ros2/messages/named_joints.h"
#include "vesalius/camera.h"

namespace vesalius::ros2 {

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
