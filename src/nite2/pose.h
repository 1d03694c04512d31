#pragma once

#include <NiteCAPI.h>

#include <Eigen/Core>
#include <array>

#include "vesalius/person.h"

namespace vesalius::nite2 {

/// Joints in the order of the interface, optical frame.
using Joints = std::array<Joint, NITE_JOINT_COUNT>;

/// Returns whether somebody holds the pose. `up` is a unit vector away from the ground. Joints that it depends on must
/// be known with at least an even chance.
bool holds_pose(const Joints& joints, NitePoseType pose, const Eigen::Vector3f& up);

}  // namespace vesalius::nite2
