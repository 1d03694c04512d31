#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "vesalius/forest.h"
#include "vesalius/image.h"

namespace vesalius {

/// A depth image as probes read it. Holes have the value that the convention gives them. Behind each row and below the
/// last one is a border with the value of the outside. Coordinates left of or above the picture are huge as unsigned
/// numbers, so limiting them to the border is the only test that a probe needs.
class PaddedDepth {
 public:
  /// Largest width and height. With it a byte offset within a row stays below 2^15 (walk_kernels.cpp).
  static constexpr int kMaxSide = 16000;

  PaddedDepth(const DepthImage& depth, const FeatureConvention& convention);

  /// Returns the number of values in a row. The border is column `border_u()` and row `border_v()`.
  int stride() const { return width_ + 1; }
  int border_u() const { return width_; }
  int border_v() const { return height_; }
  /// Returns the value of pixel (0, 0) and those behind it. All are 32768 mm less, so that they fit into int16. There
  /// is one more value before the first and after the last, since kernels read in pairs.
  const std::int16_t* values() const { return values_.data() + 1; }

  static std::int16_t biased(int depth_mm) { return static_cast<std::int16_t>(depth_mm - 32768); }

 private:
  int width_;
  int height_;
  std::vector<std::int16_t> values_;
};

}  // namespace vesalius
