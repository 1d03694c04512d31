#pragma once

#include "synth/pose/pose.h"

namespace vesalius::synth {

/// Returns the deepest overlap in metres of two limbs, or of a limb with trunk or head, on a body of standard
/// proportions with rounded shapes. It is 0 or less if nothing touches. Limbs that meet in a joint are not compared.
float self_overlap_m(const Pose& pose);

/// Largest overlap that counts as a touch (hands on hips, crossed arms and legs), since flesh yields and bodies differ.
inline constexpr float kTouch_m = 0.03F;

/// Returns whether the body intersects itself by more than a touch.
bool intersects_itself(const Pose& pose);

}  // namespace vesalius::synth
