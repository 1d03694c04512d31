#pragma once

#include "synth/pose/pose.h"

namespace vesalius::synth {

/// Returns the posture of a pose from the directions of bones and the lowest points. The person lies if trunk and
/// pelvis are low and nearly level, kneels if a knee is as low as the foot, and sits if the pelvis is low and the feet
/// are not under the body's weight. Otherwise the person stands; this includes squatting and bending.
Posture classify_posture(const Pose& pose);

/// Returns the deepest overlap in metres of two limbs, or of a limb with trunk or head, on a body of standard
/// proportions with rounded shapes. It is 0 or less if nothing touches. Limbs that meet in a joint are not compared.
float self_overlap_m(const Pose& pose);

/// Returns whether the body intersects itself by more than a touch, 30 mm.
bool intersects_itself(const Pose& pose);

}  // namespace vesalius::synth
