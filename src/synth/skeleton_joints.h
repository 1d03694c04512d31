#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "synth/body/poser.h"

namespace vesalius::synth {

/// The joints that frames carry as truth: the heads of the 19 bones of `Pose` under the bones' names ("l_forearm" is
/// the elbow), then the free ends of five: head_end, l_hand_end, r_hand_end, l_foot_end, r_foot_end.
const std::vector<std::string>& joint_names();

/// These joints of a posed body, metres, moved to the camera's frame.
std::vector<Eigen::Vector3f> joint_points(const PosedBody& body, const Eigen::Isometry3f& camera_from_body);

}  // namespace vesalius::synth
