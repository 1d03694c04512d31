#pragma once

#include <string>
#include <vector>

#include "io/recordings/transform_messages.h"
#include "ros2/messages/named_joints.h"

namespace vesalius::ros2 {

/// Returns where a person's body and joints stand, as REP-155 names them: body_<id> in the camera's frame, and in
/// body_<id> those links of human_description that are joints of a person: waist, torso, head, shoulders, elbows,
/// wrists, hips, knees, ankles (l_elbow_<id> and so on); those without a place are left out.
///
/// Axes are those of human_description: x forward, y to the person's left, z up; of a limb z points from its end to the
/// joint, and elbows and knees turn about y. body_<id> stands in the pelvis, its z along the spine. `up` points away
/// from the ground, for whoever shows too little of the trunk. The head has the trunk's axes, since nothing measures
/// its own.
std::vector<FrameTransform> human_frames(const TrackedPerson& person, const NamedJoints& joints, const std::string& id,
                                         const std::string& camera_frame, const Eigen::Vector3f& up);

}  // namespace vesalius::ros2
