#pragma once

#include "synth/pose/pose.h"

namespace vesalius::synth {

/// Returns the posture of a pose from the directions of bones and the lowest points. The person lies if trunk and
/// pelvis are low and nearly level, kneels if a knee is as low as the foot, and sits if the pelvis is low and the feet
/// are not under the body's weight. Otherwise the person stands; this includes squatting and bending.
Posture classify_posture(const Pose& pose);

}  // namespace vesalius::synth
