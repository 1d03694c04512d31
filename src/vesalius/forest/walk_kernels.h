#pragma once

#include <cstdint>

#include "vesalius/forest/packed_tree.h"
#include "vesalius/forest/padded_depth.h"
#include "vesalius/forest/walk_pixels.h"

namespace vesalius {

/// Index of the leaf that each pixel reaches, the one that `walk` in tree_walk.h finds: `leaves` takes
/// `pixels.padded_size()` values, of which the first `pixels.size()` count. The same from every instruction set.
void walk_pixels(const PackedTree& tree, const PaddedDepth& depth, const WalkPixels& pixels, std::uint32_t* leaves);

}  // namespace vesalius
