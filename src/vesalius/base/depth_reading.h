#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

namespace vesalius {

/// Returns a distance in millimetres as a depth picture has it, in whole ones. What is no number, or no distance that
/// fits into 16 bits, is no reading (as ROS has it).
inline std::uint16_t depth_reading_of_mm(double mm) {
  constexpr double kMost = std::numeric_limits<std::uint16_t>::max();
  return mm >= 0.5 && mm < kMost ? static_cast<std::uint16_t>(std::lround(mm)) : std::uint16_t{0};
}

/// Returns the same of a distance in metres.
inline std::uint16_t depth_reading(float metres) { return depth_reading_of_mm(metres * 1000.F); }

}  // namespace vesalius
