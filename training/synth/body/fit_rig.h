#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "synth/body/makehuman_rig.h"
#include "synth/body/rig_map.h"

namespace vesalius::synth {

/// A skeleton combined with its map: everything in a RigBone that does not depend on the body's shape.
struct MappedRig {
  std::vector<RigBone> bones;  ///< without ends, rests and axes
  std::array<int, kBoneCount> rig_of{};
  std::array<int, kBoneCount> tail_of{};  ///< rig bone at whose tail the bone ends; -1: it ends at the next bone's head
  std::array<RigMap::Rest, kBoneCount> rest{};
  struct Finger {
    int bone;
    float across;
  };
  std::vector<Finger> fingers;
  std::array<int, 2> first_knuckle{-1, -1}, last_knuckle{-1, -1};  ///< rig bones, left and right
};

/// Combines a skeleton with its map. Throws Error if the map names a bone that the skeleton lacks, or a root has no
/// bone of the pose to follow.
MappedRig map_rig(const std::vector<SkeletonBone>& skeleton, const RigMap& map);

/// Returns the rig of one body. `heads` and `tails` are those of all bones, in metres.
std::vector<RigBone> fit_rig(const MappedRig& rig, const std::vector<Eigen::Vector3f>& heads,
                             const std::vector<Eigen::Vector3f>& tails);

}  // namespace vesalius::synth
