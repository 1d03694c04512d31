#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "synth/body/body_mesh.h"

namespace vesalius::synth {

// Readers of MakeHuman's files. All throw Error naming the file, the line or entry, and what was expected. Lengths are
// the files' own unit (decimetres), indices count from 0.

/// All vertices of an OBJ file and the triangles of one of its groups (polygons are cut into fans).
struct ObjGroup {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Triangle> triangles;
};
/// Reads `v`, `f` and `g` and passes over the rest; vertices keep their numbers, which targets refer to. The group must
/// be a closed surface, so that a file cut short is noticed.
ObjGroup parse_obj(std::string_view text, const std::string& name, std::string_view group);

/// Offsets that a target at weight 1 adds to vertices; may be none, as for the shape that the base mesh has.
struct MorphTarget {
  std::vector<std::uint32_t> vertex;
  std::vector<Eigen::Vector3f> offset;  ///< same length
};
MorphTarget parse_target(std::string_view text, const std::string& name, std::size_t vertex_count);

/// Bone of a rig file; its ends are the means of some vertices of the morphed mesh.
struct SkeletonBone {
  std::string name;
  int parent = -1;  ///< comes before
  std::vector<std::uint32_t> head;
  std::vector<std::uint32_t> tail;
};
/// Reads an .mhskel file (JSON); parents come before their children, else in the order of names.
std::vector<SkeletonBone> parse_skeleton(std::string_view json, const std::string& name, std::size_t vertex_count);

/// Reads an .mhw file (JSON): the four largest weights of each of the first `skinned` vertices, summing to 1. The
/// file's own must sum to 1 within 0.1, as MakeHuman's do.
std::vector<SkinWeights> parse_weights(std::string_view json, const std::string& name,
                                       const std::vector<SkeletonBone>& bones, std::size_t vertex_count,
                                       const std::vector<std::uint32_t>& skinned);

}  // namespace vesalius::synth
