#pragma once

#include <Eigen/Core>
#include <array>

#include "synth/body/body_mesh.h"
#include "synth/body/builtin_shape.h"

namespace vesalius::synth {

/// The lengths of one body in metres, and factors of its flesh. `h` is the stature.
struct Measures {
  float h = 0.F;
  float male = 0.F;
  float child = 0.F;  ///< 0 from 18 years on, 1 at 4 years
  float limb = 1.F;   ///< thickness of limbs relative to the average
  float waist = 1.F;
  float trunk = 1.F;
  float head = 0.F;                                                                  ///< chin to crown
  float chin = 0.F, neck = 0.F, shoulder = 0.F, hip = 0.F, knee = 0.F, ankle = 0.F;  ///< heights above the floor
  float shoulder_x = 0.F, hip_x = 0.F;
};

/// Returns the measures of a shape. Its numbers are clamped to the range that the figure can show.
Measures measure(const BuiltinShape& shape);

/// The direction of the left arm. Arms hang 45 degrees from the body.
inline const Eigen::Vector3f kDownArm = Eigen::Vector3f(1.F, -1.F, 0.F).normalized();

/// Returns the x of the left leg's axis at a height. The legs stand apart so that thighs do not merge.
inline float leg_x(const Measures& m, float y) { return m.hip_x + 0.09F * (m.hip - y); }

/// The bones of the built-in body in addition to those of poses. Each hand has two bones for the fingers and a thumb.
enum class FingerBone : int { fingers, finger_tips, thumb };
inline constexpr int kBuiltinBoneCount = kBoneCount + 6;
/// Returns the index of a finger bone in the built-in rig.
constexpr int finger_bone(FingerBone bone, bool left) { return kBoneCount + (left ? 0 : 3) + static_cast<int>(bone); }

/// Returns the bones of the built-in rig of both sides.
std::array<BoneSegment, kBuiltinBoneCount> builtin_bones(const Measures& m);

}  // namespace vesalius::synth
