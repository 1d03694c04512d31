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

/// How deep limbs may overlap: flesh yields and bodies differ, and hands on hips, crossed arms and legs touch.
inline constexpr float kTouch_m = 0.03F;

/// Returns whether limbs overlap by more than a touch. `touch_m` is what is allowed where people press limbs together:
/// arms against trunk, thighs and each other, hands and forearms against the head, thighs against each other and the
/// trunk. Elsewhere it is 30 mm.
bool intersects_itself(const Pose& pose, float touch_m = kTouch_m);

}  // namespace vesalius::synth
