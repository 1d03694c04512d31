#pragma once

#include <cstdint>

namespace vesalius {

/// A pixel from which a forest learns.
struct TrainingSample {
  std::uint32_t frame = 0;     ///< index in the set's FrameStore
  std::int16_t u = 0, v = 0;   ///< pixel
  std::uint16_t depth_mm = 0;  ///< its reading, never 0
  std::uint8_t label = 0;      ///< class of the forest: body part, or part_count for the background
};

}  // namespace vesalius
