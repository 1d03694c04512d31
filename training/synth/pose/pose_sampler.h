#pragma once

#include <span>
#include <string>

#include "synth/pose/judge_pose.h"
#include "synth/pose/pose.h"
#include "vesalius/base/options.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// A pose and its posture.
struct SampledPose {
  Pose pose;
  Posture posture = Posture::standing;
};

/// How often each kind of pose is drawn. The numbers are weights; their sum must be above 0. All joints stay within the
/// ranges of joint_angles.h.
struct PoseSamplerOptions {
  float idle = 1.0F;
  float walking = 1.0F;
  float reaching = 1.0F;
  float waving = 0.5F;
  float bending = 0.6F;
  float arms_crossed = 0.4F;
  float arms_behind = 0.3F;
  float hands_on_hips = 0.4F;
  float carrying = 0.6F;
  float phone = 0.6F;
  float sitting = 2.0F;
  float floor_sitting = 0.4F;
  float lying = 0.6F;
  float kneeling = 0.4F;
  float squatting = 0.3F;
  float any = 0.6F;
  // The following are off unless a recipe asks for them, so that recipes written before give the same poses.
  float crawling = 0.F;
  float getting_up = 0.F;
  float turning_over = 0.F;
  float falling = 0.F;
  float sitting_up = 0.F;
  float lying_varied = 0.F;
  float picking_up = 0.F;
  float drinking = 0.F;
  float handing = 0.F;
  float hands_together = 0.F;
  float hands_on_self = 0.F;
  float leaning = 0.F;
};

void visit_options(const std::string& prefix, PoseSamplerOptions& options, OptionVisitor& visitor);

/// Returns the options that draw one kind of pose alone.
PoseSamplerOptions only(float PoseSamplerOptions::*kind);

/// Draws a pose without any files. The same options and state of `random` give the same pose. Throws UsageError if no
/// weight is above 0, or one is not a number from 0 to 1000. `touch_m` is that of intersects_itself(), here and below.
SampledPose sample_pose(const PoseSamplerOptions& options, Random& random, float touch_m = kTouch_m);

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
SampledPose draw_pose(std::span<const SampledPose> poses, float mixed, float mirrored, Random& random,
                      float touch_m = kTouch_m);

/// Returns how many of the poses have each posture: "standing 7, sitting 2, lying 1, kneeling 0".
std::string posture_counts(std::span<const SampledPose> poses);

}  // namespace vesalius::synth
