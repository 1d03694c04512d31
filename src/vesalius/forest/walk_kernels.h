#pragma once

#include <cstdint>

#include "vesalius/forest/packed_tree.h"
#include "vesalius/forest/padded_depth.h"
#include "vesalius/forest/walk_pixels.h"

namespace vesalius {

/// Writes to `leaves` the index of the leaf that each pixel reaches, the one that `walk` in tree_walk.h finds. There
/// must be room for `pixels.padded_size()` values, of which the first `pixels.size()` count. The result is the same
/// from every instruction set.
void walk_pixels(const PackedTree& tree, const PaddedDepth& depth, const WalkPixels& pixels, std::uint32_t* leaves);

}  // namespace vesalius
