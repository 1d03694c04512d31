#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "synth/body/poser.h"

namespace vesalius::synth {

/// Returns the names of the joints in the truth of frames: the heads of the 19 bones of `Pose` under the bones' names
/// ("l_forearm" is the elbow), then five free ends: head_end, l_hand_end, r_hand_end, l_foot_end, r_foot_end.
const std::vector<std::string>& joint_names();

/// Returns these joints of a posed body in metres in the camera's frame.
std::vector<Eigen::Vector3f> joint_points(const PosedBody& body, const Eigen::Isometry3f& camera_from_body);

}  // namespace vesalius::synth
