#pragma once

#include "synth/clip/person_track.h"

namespace vesalius::synth {

/// Moves a person over the floor such that the foot that carries the weight slides less, as it does where a way turns,
/// speeds up or fits the legs badly. The way stays the planned one to within about 15 cm, to which it returns within a
/// second or so. `leg_m` is the length from hip to ankle.
void plant_feet(float leg_m, PersonTrack& track);

}  // namespace vesalius::synth
