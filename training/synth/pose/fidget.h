#pragma once

#include <span>

#include "synth/pose/movement.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// Returns a movement of somebody who stays as in `base` and now and then takes arms and head to where another of the
/// poses has them, within human speed: 30 states a second. Other poses with which the body would intersect itself are
/// left out; without any left the person keeps still.
Movement fidget(const Pose& base, std::span<const Pose> others, float seconds, Random& random);

}  // namespace vesalius::synth
