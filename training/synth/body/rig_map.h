#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "synth/body/body_mesh.h"
#include "synth/body/makehuman_files.h"

namespace vesalius::synth {

/// How the bones of a rig file follow those of poses. The fields are explained in data/rigs/makehuman_default.toml.
struct RigMap {
  enum class Rest { keep, straighten, follow };
  struct Joint {
    std::string joint;  ///< rig bone whose head is the joint
    std::string tail;   ///< rig bone whose tail is the end; empty if the next bone begins there
    Rest rest = Rest::keep;
  };
  struct Follow {
    std::string rig;
    Bone from = Bone::pelvis;
    Bone to = Bone::pelvis;
    float blend = 0.F;
    bool twist = false;
  };
  struct Finger {
    std::string rig;
    Grip hand = Grip::left;
    float radians = 0.F;
    float across = 0.F;
  };

  std::string name;
  std::array<Joint, kBoneCount> bones;
  std::vector<Follow> follows;
  std::vector<Finger> fingers;
  std::array<std::string, 2> first_knuckle, last_knuckle;  ///< left and right; empty if there are no fingers
};

/// Parses a map. Throws Error naming line and expectation.
RigMap parse_rig_map(std::string_view toml, const std::string& name);

/// Returns the map of data/rigs/makehuman_default.toml.
const RigMap& makehuman_rig_map();

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
