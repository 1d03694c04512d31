#pragma once

#include <cstdint>

#include "vesalius/frame_source.h"
#include "vesalius/image.h"

namespace vesalius {

/// What 7-Scenes and others store where there is no reading, whatever their unit.
inline constexpr std::uint16_t kNoReading = 0xFFFF;

/// How the depth of pictures is stored.
struct StoredDepth {
  float units_per_m = 1000.F;     ///< of whole numbers
  float float_units_per_m = 1.F;  ///< of numbers with a fraction
  DepthBits bits = DepthBits::plain;
};

/// Returns how depth is stored by what is said of it: in millimetres and metres, where nothing is.
inline StoredDepth stored_depth(const SourceOptions& said) {
  return {said.depth_scale.value_or(1000.F), said.depth_scale.value_or(1.F), said.depth_bits};
}

/// Returns the number that was stored so.
inline std::uint16_t restored(std::uint16_t stored, DepthBits bits) {
  switch (bits) {
    case DepthBits::swapped:
      return static_cast<std::uint16_t>(stored << 8 | stored >> 8);
    case DepthBits::rotated:
      return static_cast<std::uint16_t>(stored >> 3 | stored << 13);
    default:
      return stored;
  }
}

inline void restore(Image<std::uint16_t>& stored, DepthBits bits) {
  if (bits == DepthBits::plain) return;
  for (std::uint16_t& value : stored) value = restored(value, bits);
}

}  // namespace vesalius
