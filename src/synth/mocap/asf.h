#pragma once

#include <Eigen/Geometry>
#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace vesalius::synth {

/// Bone of an ASF skeleton.
struct AsfBone {
  std::string name;
  int parent = -1;                                           ///< -1 for the root; parents come first
  Eigen::Vector3f direction = Eigen::Vector3f::Zero();       ///< unit, world frame at rest; zero for the root
  float length = 0.F;                                        ///< the file's unit
  Eigen::Quaterniond axis = Eigen::Quaterniond::Identity();  ///< world_from_axis: the frame that angles refer to
  std::vector<int> dofs;                   ///< what the numbers of a motion line are: 0-2 tx-tz, 3-5 rx-rz, 6 length
  std::array<int, 3> turn_order{0, 1, 2};  ///< axes in the order in which their rotations are applied
};

/// Skeleton of an Acclaim motion capture: bones[0] is the root.
struct AsfSkeleton {
  std::string name;
  std::vector<AsfBone> bones;
  bool degrees = true;  ///< unit of angles in its motions, where they do not say
};

/// Parses an ASF file. `name` stands for the file in errors. Throws Error naming line and expectation.
AsfSkeleton parse_asf(std::string_view text, const std::string& name);

}  // namespace vesalius::synth
