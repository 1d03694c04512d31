#pragma once

#include <span>

#include "synth/pose/pose_sampler.h"

namespace vesalius::synth {

/// The limbs that one pose can take from another.
struct Limbs {
  bool l_arm = false;  ///< clavicle to hand, and its grip
  bool r_arm = false;
  bool legs = false;  ///< with the pelvis' tilt, which belongs to them
  bool head = false;  ///< neck and head
};

/// `pose` with those limbs of `other`.
Pose mix_limbs(const Pose& pose, const Pose& other, const Limbs& limbs);

/// Draws one of the poses: with probability `mixed` some of its limbs come from another of the same posture, as long
/// as the body does not run through itself then; with probability `mirrored` as seen in a mirror. Motion capture
/// leaves out fingers: grips are drawn. Throws UsageError where there are no poses.
SampledPose draw_pose(std::span<const SampledPose> poses, float mixed, float mirrored, Random& random);

}  // namespace vesalius::synth
