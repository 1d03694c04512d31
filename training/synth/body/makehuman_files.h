#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "synth/body/body_mesh.h"

namespace vesalius::synth {

// Readers of MakeHuman's meshes, morph targets and rigs. They throw Error naming the file, the line or entry, and what
// was expected. Lengths are in the files' own unit, decimetres; indices count from 0.

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

/// A bone of a rig file. Its ends are the means of some vertices of the morphed mesh.
struct SkeletonBone {
  std::string name;
  int parent = -1;  ///< index of the parent, which comes before the bone
  std::vector<std::uint32_t> head;
  std::vector<std::uint32_t> tail;
};
/// Reads an .mhskel file (JSON). Parents come before their children; otherwise bones are in the order of their names.
std::vector<SkeletonBone> parse_skeleton(std::string_view json, const std::string& name, std::size_t vertex_count);

/// Reads an .mhw file (JSON): the four largest weights of each of the first `skinned` vertices, scaled to sum to 1. In
/// the file they must sum to 1 within 0.1, as MakeHuman's do.
std::vector<SkinWeights> parse_weights(std::string_view json, const std::string& name,
                                       const std::vector<SkeletonBone>& bones, std::size_t vertex_count,
                                       const std::vector<std::uint32_t>& skinned);

}  // namespace vesalius::synth
