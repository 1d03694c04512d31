#pragma once

#include "synth/furniture/furniture.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// Returns a desk behind which somebody sits towards +z, whose near edge is at z = 0: with screens that they look at,
/// some small things, and often a front. `height_m` is that of its top.
Furniture make_desk_before(float height_m, Random& random);

/// Returns a closed counter, whose near side is at z = 0, with things on it.
Furniture make_counter(float height_m, Random& random);

}  // namespace vesalius::synth
