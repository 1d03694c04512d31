#include "synth/mocap/motion.h"

#include <algorithm>

namespace vesalius::synth {

int Motion::find_joint(std::string_view joint_name) const {
  const auto found = std::ranges::find(joints, joint_name, &MotionJoint::name);
  return found == joints.end() ? -1 : int(found - joints.begin());
}

Eigen::Quaterniond axis_rotation(int axis, double angle_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::Unit(axis)));
}

}  // namespace vesalius::synth
