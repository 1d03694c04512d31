#pragma once

#include <array>
#include <vector>

#include "synth/body/builtin_body.h"
#include "synth/body/limb.h"

namespace vesalius::synth {

/// Bones of the built-in body beside those of poses: fingers in two pieces and a thumb, per hand.
enum class FingerBone : int { fingers, finger_tips, thumb };
inline constexpr int kBuiltinBoneCount = kBoneCount + 6;
/// Index of a finger bone in the built-in rig.
constexpr int finger_bone(FingerBone bone, bool left) { return kBoneCount + (left ? 0 : 3) + static_cast<int>(bone); }

/// Skeleton and flesh of the built-in body: standing, arms 45 degrees down, palms facing the thighs. Metres.
struct BuiltinFigure {
  std::array<BoneSegment, kBuiltinBoneCount> bones;  ///< of the built-in rig
  std::vector<Limb> limbs;                           ///< paired ones: the left
};
BuiltinFigure builtin_figure(const BuiltinShape& shape);

}  // namespace vesalius::synth
