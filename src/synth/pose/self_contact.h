#pragma once

#include "synth/pose/pose.h"

namespace vesalius::synth {

/// Deepest overlap of two limbs, or of a limb with trunk or head, on a body of standard proportions and rounded
/// shapes, metres; 0 or less where nothing touches. Limbs that meet in a joint are not compared.
float self_overlap_m(const Pose& pose);

/// Flesh gives way and bodies differ: so much overlap is a touch (hands on hips, crossed arms and legs).
inline constexpr float kTouch_m = 0.03F;

/// Returns whether the body runs through itself by more than a touch.
bool intersects_itself(const Pose& pose);

}  // namespace vesalius::synth
