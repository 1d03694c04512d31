#pragma once

#include <algorithm>
#include <cstdint>

#include "vesalius/image.h"

namespace vesalius {

/// Returns the colour of luminance and chrominance as television has them (BT.601, 16 to 235), in 256ths.
inline Rgb rgb_of_yuv(int y, int u, int v) {
  constexpr int kScale = 298, kRound = 128, kShift = 8;
  const int c = kScale * (y - 16) + kRound, d = u - 128, e = v - 128;
  const auto byte = [](int value) { return static_cast<std::uint8_t>(std::clamp(value >> kShift, 0, 255)); };
  return {byte(c + 409 * e), byte(c - 100 * d - 208 * e), byte(c + 516 * d)};
}

}  // namespace vesalius
