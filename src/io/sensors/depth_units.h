#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "vesalius/image.h"

namespace vesalius {

/// Turns depth in other units into millimetres, each of them `to_mm` long. What is beyond 65.5 m becomes no reading.
inline void to_millimetres(DepthImage& depth, double to_mm) {
  constexpr double kSame = 1e-6;
  if (std::abs(to_mm - 1.0) < kSame) return;
  for (std::uint16_t& z : depth) {
    const double z_mm = to_mm * z;
    z = z_mm < std::numeric_limits<std::uint16_t>::max() ? static_cast<std::uint16_t>(std::lround(z_mm))
                                                         : std::uint16_t{0};
  }
}

}  // namespace vesalius
