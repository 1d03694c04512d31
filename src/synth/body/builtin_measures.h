#pragma once

#include <Eigen/Core>
#include <array>

#include "synth/body/body_mesh.h"
#include "synth/body/builtin_shape.h"

namespace vesalius::synth {

/// Lengths of one body, metres, and what shapes its flesh. `h` is the stature.
struct Measures {
  float h = 0.F;
  float male = 0.F;
  float child = 0.F;  ///< 0 from 18 years on, 1 at 4
  float limb = 1.F;   ///< thickness of limbs against the average
  float waist = 1.F;
  float trunk = 1.F;
  float head = 0.F;                                                                  ///< chin to crown
  float chin = 0.F, neck = 0.F, shoulder = 0.F, hip = 0.F, knee = 0.F, ankle = 0.F;  ///< heights
  float shoulder_x = 0.F, hip_x = 0.F;
};

/// Returns the measures of a shape, whose numbers are kept within what the figure can show.
Measures measure(const BuiltinShape& shape);

/// The direction of the left arm: arms hang 45 degrees from the body.
inline const Eigen::Vector3f kDownArm = Eigen::Vector3f(1.F, -1.F, 0.F).normalized();

/// Returns where the left leg's line is at a height: the legs stand apart, so that thighs do not melt together.
inline float leg_x(const Measures& m, float y) { return m.hip_x + 0.09F * (m.hip - y); }

/// Bones of the built-in body beside those of poses: fingers in two pieces and a thumb, per hand.
enum class FingerBone : int { fingers, finger_tips, thumb };
inline constexpr int kBuiltinBoneCount = kBoneCount + 6;
/// Returns the index of a finger bone in the built-in rig.
constexpr int finger_bone(FingerBone bone, bool left) { return kBoneCount + (left ? 0 : 3) + static_cast<int>(bone); }

/// Returns the bones of the built-in rig, left and right.
std::array<BoneSegment, kBuiltinBoneCount> builtin_bones(const Measures& m);

}  // namespace vesalius::synth
