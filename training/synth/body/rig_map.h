#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "synth/body/body_mesh.h"

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

}  // namespace vesalius::synth
