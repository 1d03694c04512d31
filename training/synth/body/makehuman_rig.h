#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "synth/body/body_mesh.h"

namespace vesalius::synth {

// Readers of MakeHuman's rigs. They throw Error naming the file, the entry and what was expected. Indices count from 0.

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
