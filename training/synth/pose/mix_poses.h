#pragma once

#include <span>

#include "synth/pose/pose_sampler.h"

namespace vesalius::synth {

/// The limbs that one pose can take from another.
struct Limbs {
  bool l_arm = false;  ///< clavicle to hand, with its grip
  bool r_arm = false;
  bool legs = false;  ///< with the tilt of the pelvis, which belongs to the legs
  bool head = false;  ///< head and neck
};

/// Returns `pose` with those limbs of `other`.
Pose mix_limbs(const Pose& pose, const Pose& other, const Limbs& limbs);

/// Draws one of the poses. With probability `mixed` some of its limbs come from another pose of the same posture,
/// unless the body then intersects itself; with probability `mirrored` it is mirrored. Grips are drawn at random
/// because motion capture does not record fingers. Throws UsageError if there are no poses.
SampledPose draw_pose(std::span<const SampledPose> poses, float mixed, float mirrored, Random& random);

}  // namespace vesalius::synth
