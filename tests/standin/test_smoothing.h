#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>

#include "vesalius/image.h"

namespace vesalius::test {

/// Returns a picture of a camera that trembles: every second one is 3 cm further away.
inline DepthImage shaken(DepthImage depth, std::uint64_t number) {
  if (number % 2 != 0) return depth;
  for (std::uint16_t& z : depth) z = z == 0 ? z : static_cast<std::uint16_t>(z + 30);
  return depth;
}

/// Expects that more smoothing, from 0 to 1, leaves less of it. `spread` returns how far a joint moved to and fro with
/// so much smoothing, millimetres.
inline void expect_smoothing(const std::function<float(float factor)>& spread) {
  const float raw = spread(0.F), half = spread(0.5F), full = spread(1.F);
  EXPECT_GT(raw, 50.F) << "millimetres";
  EXPECT_LT(half, 0.8F * raw);
  EXPECT_LT(full, 0.5F * half);
}

}  // namespace vesalius::test
