#pragma once

#include <string>

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
};

void visit_options(const std::string& prefix, PoseSamplerOptions& options, OptionVisitor& visitor);

/// Draws a pose without any files. The same options and state of `random` give the same pose. Throws UsageError if no
/// weight is above 0, or one is not a number from 0 to 1000.
SampledPose sample_pose(const PoseSamplerOptions& options, Random& random);

}  // namespace vesalius::synth
