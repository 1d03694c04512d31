#include "synth/pose/mix_poses.h"

#include <initializer_list>

#include "synth/pose/posture.h"
#include "synth/pose/self_contact.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr int kTries = 20;

void take(Pose& pose, const Pose& other, std::initializer_list<Bone> bones) {
  for (const Bone bone : bones) pose[bone] = other[bone];
}

Limbs draw_limbs(Random& random) {
  const std::uint32_t bits = 1 + random.below(15);
  return {(bits & 1U) != 0, (bits & 2U) != 0, (bits & 4U) != 0, (bits & 8U) != 0};
}

SampledPose draw_mixed(std::span<const SampledPose> poses, const SampledPose& base, Random& random) {
  for (int i = 0; i < kTries; ++i) {
    const SampledPose& other = poses[random.below(static_cast<std::uint32_t>(poses.size()))];
    const Limbs limbs = draw_limbs(random);
    if (other.posture != base.posture) continue;
    const Pose mixed = mix_limbs(base.pose, other.pose, limbs);
    if (!intersects_itself(mixed) && classify_posture(mixed) == base.posture) return {mixed, base.posture};
  }
  return base;
}

}  // namespace

Pose mix_limbs(const Pose& pose, const Pose& other, const Limbs& limbs) {
  Pose out = pose;
  if (limbs.l_arm) {
    take(out, other, {Bone::l_clavicle, Bone::l_upper_arm, Bone::l_forearm, Bone::l_hand});
    out.l_grip = other.l_grip;
  }
  if (limbs.r_arm) {
    take(out, other, {Bone::r_clavicle, Bone::r_upper_arm, Bone::r_forearm, Bone::r_hand});
    out.r_grip = other.r_grip;
  }
  if (limbs.legs) {
    take(out, other, {Bone::pelvis, Bone::l_thigh, Bone::l_shin, Bone::l_foot});
    take(out, other, {Bone::r_thigh, Bone::r_shin, Bone::r_foot});
  }
  if (limbs.head) take(out, other, {Bone::neck, Bone::head});
  return out;
}

SampledPose draw_pose(std::span<const SampledPose> poses, float mixed, float mirrored_share, Random& random) {
  if (poses.empty()) throw UsageError("draw_pose: expected at least one pose");
  const SampledPose& base = poses[random.below(static_cast<std::uint32_t>(poses.size()))];
  SampledPose drawn = random.uniform() < mixed ? draw_mixed(poses, base, random) : base;
  drawn.pose.l_grip = float(random.uniform(0.0, 0.9));
  drawn.pose.r_grip = float(random.uniform(0.0, 0.9));
  if (random.uniform() < mirrored_share) drawn.pose = mirrored(drawn.pose);
  return drawn;
}

}  // namespace vesalius::synth
