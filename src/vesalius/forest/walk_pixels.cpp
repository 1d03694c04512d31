#include "vesalius/forest/walk_pixels.h"

#include <algorithm>

#include "vesalius/forest/padded_depth.h"

namespace vesalius {
namespace {

/// A bound of probes, biased, in both halves.
std::int32_t both_halves(int mm) {
  const std::uint32_t half = static_cast<std::uint16_t>(PaddedDepth::biased(mm));
  return static_cast<std::int32_t>(half << 16U | half);
}

}  // namespace

WalkPixels::WalkPixels(std::size_t most, const OffsetScaler& scaler, const FeatureConvention& convention)
    : scaler_(scaler), clip_mm_(convention.clip_mm != 0 ? convention.clip_mm : 65535) {
  for (std::vector<std::int32_t>& column : columns_) column.resize((most + kBlock - 1) / kBlock * kBlock);
}

WalkPixels::WalkPixels(const DepthImage& depth, int begin, int end, const OffsetScaler& scaler,
                       const FeatureConvention& convention)
    : WalkPixels(static_cast<std::size_t>(depth.width()) * static_cast<std::size_t>(end - begin), scaler, convention) {
  for (int v = begin; v < end; ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      if (depth(u, v) != 0) add(u, v, depth(u, v));
    }
  }
}

void WalkPixels::add(int u, int v, std::uint16_t depth_mm) {
  const OffsetScale scale = scaler_.at(depth_mm);
  columns_[kU][size_] = u;
  columns_[kV][size_] = v;
  columns_[kScaleU][size_] = scale.u;
  columns_[kScaleV][size_] = scale.v;
  columns_[kLow][size_] = both_halves(std::max(depth_mm - clip_mm_, 0));
  columns_[kHigh][size_] = both_halves(std::min(depth_mm + clip_mm_, 65535));
  ++size_;
}

}  // namespace vesalius
