#pragma once

#include "synth/furniture/furniture.h"

namespace vesalius::synth {

// Chairs of many shapes, about the origin. A tenth of each kind lies on the floor.

/// Returns a chair or stool on five feet with castors. Parts may be black, as leather and nets are.
Furniture make_swivel_chair(Random& random);

/// Returns a kitchen or bar chair, or a stack of them.
Furniture make_plain_chair(Random& random);

}  // namespace vesalius::synth
