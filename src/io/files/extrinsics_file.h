#pragma once

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace vesalius {

/// Returns the rows of [turn | place], in full precision: distances grow with errors of the turn.
nlohmann::ordered_json pose_json(const Eigen::Isometry3f& pose);
/// Reads such rows. Throws Error naming `what` for anything else than three rows of four numbers.
Eigen::Isometry3f parse_pose(const nlohmann::ordered_json& json, const std::string& what);

/// Where a camera stands that sees the same people as others (docs/formats.md).
struct CameraExtrinsics {
  std::string source;                                                 ///< its name, for people
  Eigen::Isometry3f first_from_this = Eigen::Isometry3f::Identity();  ///< optical frames, metres
};

/// Parses the extrinsics of cameras. Throws Error naming `source`, the place and what was expected: for another number
/// of cameras than `count`, for what is no rigid transformation, and for a first camera that is not the identity.
std::vector<CameraExtrinsics> parse_extrinsics(std::string_view text, const std::string& source, std::size_t count);

/// Returns the text of such a file.
std::string extrinsics_json(const std::vector<CameraExtrinsics>& cameras);

}  // namespace vesalius
