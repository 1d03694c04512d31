#pragma once

#include <cmath>
#include <cstdint>

namespace vesalius {

/// Returns a distance in metres as a depth picture has it, in whole millimetres. What is no number, or no distance that
/// fits, is no reading (as ROS has it).
inline std::uint16_t depth_reading(float metres) {
  const float mm = metres * 1000.F;
  return mm >= 0.5F && mm < 65535.F ? static_cast<std::uint16_t>(std::lround(mm)) : std::uint16_t{0};
}

}  // namespace vesalius
