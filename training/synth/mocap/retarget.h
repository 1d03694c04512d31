#pragma once

#include <vector>

#include "synth/mocap/motion.h"
#include "synth/mocap/motion_convention.h"
#include "synth/pose/movement.h"
#include "synth/pose/pose.h"

namespace vesalius::synth {

/// Throws Error naming a joint that the motion lacks, or a bone with RestRule::aim whose joint has no direction.
void check_fit(const Motion& motion, const MotionConvention& convention);

/// Returns the first convention whose joints the motion has. Throws Error naming the motion if none fits.
const MotionConvention& find_convention(const Motion& motion, const std::vector<MotionConvention>& conventions);

/// Returns the pose of every frame except the first `skip_frames`. The heading of the pelvis is removed. Throws Error
/// if motion and convention do not fit.
std::vector<Pose> retarget(const Motion& motion, const MotionConvention& convention);

/// Returns the same poses with the headings of the pelvis, continuous from frame to frame, and the ways of the root
/// over the floor in lengths of the motion's own legs. Throws Error if motion and convention do not fit, the legs have
/// no length, or no frame is left.
Movement retarget_movement(const Motion& motion, const MotionConvention& convention);

}  // namespace vesalius::synth
