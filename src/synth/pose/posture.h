#pragma once

#include "synth/pose/pose.h"

namespace vesalius::synth {

/// Returns what a person in this pose needs under them, judged by where bones point and what is lowest: lying where
/// trunk and pelvis are near level and low, kneeling on a knee that is as low as the foot, sitting where the pelvis is
/// low and the feet do not stand under the weight; else standing (squatting and bending too).
Posture classify_posture(const Pose& pose);

}  // namespace vesalius::synth
