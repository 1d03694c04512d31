#pragma once

#include <Eigen/Geometry>
#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace vesalius::synth {

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

/// Parses an ASF file; `name` is used as the path in errors. Throws Error naming line and expectation.
AsfSkeleton parse_asf(std::string_view text, const std::string& name);

}  // namespace vesalius::synth
