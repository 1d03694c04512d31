#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "synth/body/body_mesh.h"

namespace vesalius::synth {

// Readers of MakeHuman's meshes and morph targets. They throw Error naming the file, the line and what was expected.
// Lengths are in the files' own unit, decimetres; indices count from 0.

/// All vertices of an OBJ file and the triangles of one of its groups (polygons are cut into fans).
struct ObjGroup {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Triangle> triangles;
};
/// Reads `v`, `f` and `g` and ignores everything else. Vertices keep their numbers because targets refer to them. The
/// group must be a closed surface, so that a truncated file is noticed.
ObjGroup parse_obj(std::string_view text, const std::string& name, std::string_view group);

/// The offsets that a target at weight 1 adds to vertices. There may be none, as for the target that has the shape of
/// the base mesh.
struct MorphTarget {
  std::vector<std::uint32_t> vertex;
  std::vector<Eigen::Vector3f> offset;  ///< one for each vertex
};
MorphTarget parse_target(std::string_view text, const std::string& name, std::size_t vertex_count);

}  // namespace vesalius::synth
