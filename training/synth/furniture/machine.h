#pragma once

#include "synth/furniture/furniture.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// Returns a robot or an upright machine, 0.4 to 1.9 m high: a base, a column, perhaps a trunk and a head, and up to
/// two arms of several links.
Furniture make_machine(Random& random);

}  // namespace vesalius::synth
