#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "vesalius/forest/tree_walk.h"
#include "vesalius/image.h"

namespace vesalius {

/// Pixels with a reading, as the kernel takes them: a column for each property.
class WalkPixels {
 public:
  /// Pixels that the kernel takes at a time.
  static constexpr std::size_t kBlock = 64;
  enum Column { kU, kV, kScaleU, kScaleV, kLow, kHigh, kColumns };

  /// Makes room for `most` pixels.
  WalkPixels(std::size_t most, const OffsetScaler& scaler, const FeatureConvention& convention);

  /// Takes the pixels with a reading of rows `begin` to `end` - 1, row by row.
  WalkPixels(const DepthImage& depth, int begin, int end, const OffsetScaler& scaler,
             const FeatureConvention& convention);

  /// Adds a pixel; `depth_mm` must be above 0.
  void add(int u, int v, std::uint16_t depth_mm);

  std::size_t size() const { return size_; }
  /// Returns `size()` brought up to a multiple of kBlock. Behind the last pixel columns hold zeros.
  std::size_t padded_size() const { return (size_ + kBlock - 1) / kBlock * kBlock; }
  /// Returns a property of all pixels. `kLow` and `kHigh` are what probes are clamped to, biased as the values of
  /// PaddedDepth, in both halves of a number.
  const std::int32_t* column(Column c) const { return columns_[c].data(); }

 private:
  OffsetScaler scaler_;
  int clip_mm_;
  std::array<std::vector<std::int32_t>, kColumns> columns_;
  std::size_t size_ = 0;
};

}  // namespace vesalius
