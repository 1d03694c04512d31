#pragma once

#include <Eigen/Geometry>
#include <string>
#include <string_view>
#include <vector>

namespace vesalius::synth {

/// A joint of a motion file's own skeleton, and the bone that its rotation turns.
struct MotionJoint {
  std::string name;
  int parent = -1;                                   ///< -1 for the root; parents come first
  Eigen::Vector3f offset = Eigen::Vector3f::Zero();  ///< from the parent joint at rest, in the file's unit of length
  Eigen::Vector3f along = Eigen::Vector3f::Zero();   ///< unit direction of the bone at rest; zero if unknown
};

/// A recorded motion. In its world frame y points up. At rest every rotation is the identity.
struct Motion {
  std::string name;
  float fps = 0.F;  ///< frames per second
  std::vector<MotionJoint> joints;
  std::vector<Eigen::Quaternionf> world;  ///< [frame * joints + joint]: world_from_joint
  std::vector<Eigen::Vector3f> root;      ///< [frame]: position of the root, in the file's unit of length

  int joint_count() const { return int(joints.size()); }
  int frame_count() const { return int(root.size()); }
  const Eigen::Quaternionf& rotation(int frame, int joint) const { return world[frame * joints.size() + joint]; }
  /// Returns the index of the joint of that name, or -1 if there is none.
  int find_joint(std::string_view joint_name) const;
};

/// Limits on the joints and rotations (frames x joints) of a motion file. For comparison, an hour of 31 joints at 120
/// frames per second has 13 million rotations.
inline constexpr int kMaxMotionJoints = 1000;
inline constexpr std::size_t kMaxMotionRotations = std::size_t{1} << 24;

/// Returns the rotation by `angle_rad` about axis 0 (x), 1 (y) or 2 (z).
Eigen::Quaterniond axis_rotation(int axis, double angle_rad);

}  // namespace vesalius::synth
