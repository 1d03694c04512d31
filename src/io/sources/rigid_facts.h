#pragma once

#include <Eigen/Geometry>
#include <string>
#include <string_view>
#include <vector>

#include "io/sources/fact_tree.h"

namespace vesalius {

/// Whose a calibration is, as names tell; of two without names, as OpenCV numbers them.
enum class CameraRole { unsaid, depth, colour, first, second };

/// A rotation and a translation that a calibration has.
struct RigidFact {
  CameraRole from = CameraRole::unsaid;  ///< points are taken from its frame ...
  CameraRole to = CameraRole::unsaid;    ///< ... to its frame; one alone is unsaid where all refer to a third frame
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();  ///< metres
  std::string origin;                                           ///< the file
  bool in_one_list = false;  ///< whether the rotation is a list of nine, which librealsense writes column by column
};

/// Returns whose a calibration is by words in a text of letters and digits: "calibcolor", "depthintrinsic".
CameraRole role_in(std::string_view text);

/// Returns the rotations with translations of a file whose name is `name`, in the frames that the names around them
/// tell: "depth_to_color", "d2c", "rgb2ir", "extrinsics" under "depth". Those that are no rigid transforms between
/// cameras of one device are left out.
std::vector<RigidFact> rigid_facts(const FactTree& root, const std::string& name);

}  // namespace vesalius
