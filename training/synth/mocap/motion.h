#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
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
  int find_joint(std::string_view joint_name) const {
    const auto found = std::ranges::find(joints, joint_name, &MotionJoint::name);
    return found == joints.end() ? -1 : int(found - joints.begin());
  }
};

/// Limits on the joints and rotations (frames x joints) of a motion file. For comparison, an hour of 31 joints at 120
/// frames per second has 13 million rotations.
inline constexpr int kMaxMotionJoints = 1000;
inline constexpr std::size_t kMaxMotionRotations = std::size_t{1} << 24;

/// Returns the rotation by `angle_rad` about axis 0 (x), 1 (y) or 2 (z).
inline Eigen::Quaterniond axis_rotation(int axis, double angle_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle_rad, Eigen::Vector3d::Unit(axis)));
}

// Readers of motion files. `name` is used as the path in errors. They throw Error naming line and expectation.

/// Parses a BVH file (Biovision hierarchy) with 0 to 6 channels for each joint in any order and angles in degrees.
/// Positions of joints other than the root are ignored. A bone points to the joint's first child that is not at the
/// joint itself. Refuses a line of motion with too few or too many numbers, numbers that are not finite, and more than
/// kMaxMotionJoints joints.
Motion parse_bvh(std::string_view text, const std::string& name);

/// A bone of an ASF skeleton.
struct AsfBone {
  std::string name;
  int parent = -1;                                      ///< -1 for the root; parents come first
  Eigen::Vector3f direction = Eigen::Vector3f::Zero();  ///< unit vector in the world frame at rest; zero for the root
  float length = 0.F;                                   ///< in the file's unit
  Eigen::Quaterniond axis = Eigen::Quaterniond::Identity();  ///< world_from_axis, the frame to which angles refer
  std::vector<int> dofs;                   ///< the numbers of a motion line: 0-2 are tx-tz, 3-5 rx-rz, 6 is the length
  std::array<int, 3> turn_order{0, 1, 2};  ///< axes in the order in which their rotations are applied
};

/// The skeleton of an Acclaim motion capture. bones[0] is the root.
struct AsfSkeleton {
  std::string name;
  std::vector<AsfBone> bones;
  bool degrees = true;  ///< whether angles are in degrees if a motion does not say so
};

/// Parses an ASF file.
AsfSkeleton parse_asf(std::string_view text, const std::string& name);

/// Parses an AMC file, which holds motion of a skeleton. A bone's rotation is C M C^-1, where C comes from its axis and
/// M is the product of its dofs; values that a frame leaves out are 0. AMC files do not state their frame rate, so
/// `fps` gives it. Refuses a bone that the skeleton lacks.
Motion parse_amc(std::string_view text, const std::string& name, const AsfSkeleton& skeleton, float fps);

}  // namespace vesalius::synth
