#pragma once

#include <vector>

#include "synth/mocap/motion.h"
#include "synth/mocap/motion_convention.h"
#include "synth/pose/pose.h"

namespace vesalius::synth {

/// Throws Error naming the joint that a motion lacks, or a bone to aim whose joint has no direction.
void check_fit(const Motion& motion, const MotionConvention& convention);

/// Returns the first convention whose joints the motion has. Throws Error naming the motion where none fits.
const MotionConvention& find_convention(const Motion& motion, const std::vector<MotionConvention>& conventions);

/// Returns the pose of every frame but the first `skip_frames`; the pelvis has no heading. Throws Error where motion
/// and convention do not fit.
std::vector<Pose> retarget(const Motion& motion, const MotionConvention& convention);

}  // namespace vesalius::synth
