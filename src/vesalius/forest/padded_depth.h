#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "vesalius/base/image.h"
#include "vesalius/forest/forest.h"

namespace vesalius {

/// A depth image as probes read it: holes hold what the convention says they count as, and behind each row and below
/// the last one lies a border of what the outside reads. Unsigned, coordinates left of or above the picture are huge,
/// so bringing them down to the border is all the test a probe needs.
class PaddedDepth {
 public:
  /// Largest width and height: a byte offset within a row stays below 2^15 (walk_kernels.cpp).
  static constexpr int kMaxSide = 16000;

  PaddedDepth(const DepthImage& depth, const FeatureConvention& convention);

  /// Values per row; the border is column `border_u()` and row `border_v()`.
  int stride() const { return width_ + 1; }
  int border_u() const { return width_; }
  int border_v() const { return height_; }
  /// Value of pixel (0, 0) less 32768, as all of them, so that differences are those of int16. One more value lies
  /// before it and behind the last, as kernels read in pairs.
  const std::int16_t* values() const { return values_.data() + 1; }

  static std::int16_t biased(int depth_mm) { return static_cast<std::int16_t>(depth_mm - 32768); }

 private:
  int width_;
  int height_;
  std::vector<std::int16_t> values_;
};

}  // namespace vesalius
