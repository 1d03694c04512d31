#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "synth/pose/pose.h"

namespace vesalius::synth {

/// How a bone lies while the skeleton of a motion file is at rest, against the T of `Pose`.
enum class RestRule : std::uint8_t {
  same,  ///< the same way: the joint's rotation is the bone's
  aim,   ///< elsewhere: the smallest turn from the T's direction to the joint's own comes first
  like   ///< whatever turn another bone has
};

/// Where the rotation of one bone comes from.
struct BoneSource {
  std::vector<std::string> from;  ///< one joint, or two: half way between them
  RestRule rest = RestRule::same;
  Bone like = Bone::pelvis;  ///< for RestRule::like; its own rule is same or aim
};

/// How the joints of one family of motion files map to the bones of a pose. Data: see data/rigs.
struct MotionConvention {
  std::string name;
  int skip_frames = 0;  ///< frames at the start that nobody took (a T pose)
  std::array<BoneSource, kBoneCount> bones;
};

/// Parses such a mapping from TOML. Throws Error naming line and expectation; every bone must be there.
MotionConvention parse_convention(std::string_view toml, const std::string& name);

/// Returns the conventions that come with the program: asf_amc, cmu_bvh, daz_bvh.
const std::vector<MotionConvention>& builtin_conventions();

}  // namespace vesalius::synth
