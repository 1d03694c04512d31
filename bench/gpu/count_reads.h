#pragma once

#include <cstdint>

#include "vesalius/camera.h"
#include "vesalius/forest.h"
#include "vesalius/image.h"

namespace vesalius {

/// What walking the pixels of a picture reads, as a card would: 32 neighbouring pixels in step, in sectors of 32 bytes.
struct WalkReads {
  std::uint64_t pixels = 0;         ///< that are walked
  std::uint64_t nodes = 0;          ///< inner nodes that pixels pass, over all trees
  std::uint64_t warp_levels = 0;    ///< levels that groups of 32 pixels take until the last is in a leaf
  std::uint64_t node_sectors = 0;   ///< sectors of nodes, each once for a group and level
  std::uint64_t probe_sectors = 0;  ///< sectors of depth likewise
  std::uint64_t forest_bytes = 0;   ///< of all nodes
  std::uint64_t touched_bytes = 0;  ///< of sectors of nodes that any pixel reads
  std::uint64_t logit_bytes = 0;    ///< of all leaves' logits
};

/// Counts over all pixels that have a reading and are not `settled`; an empty mask settles none.
WalkReads count_reads(const Forest& forest, const DepthImage& depth, const Camera& camera, const Mask& settled);

}  // namespace vesalius
