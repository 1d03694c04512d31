#pragma once

#include "synth/sensor/render.h"

namespace vesalius::synth {

/// Adds the light that reaches a time-of-flight camera by way of a second surface: floor and wall light each other, so
/// that corners come out round and a body by a wall lies deeper. Surfaces reflect by Lambert's law the share of
/// infrared light that the rendering states, `strength` times as much; only those that the camera sees do. The mixture
/// is read from its phase, of light that is modulated 100 million times a second, as the sensors' middle frequencies
/// are. It is reckoned for 32 columns of patches and spread to the pixels near each in space.
void add_multipath(float strength, Rendering& rendering);

}  // namespace vesalius::synth
