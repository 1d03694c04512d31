#include "vesalius/walk_pixels.h"

#include <algorithm>

#include "vesalius/padded_depth.h"

namespace vesalius {

WalkPixels::WalkPixels(const DepthImage& depth, int begin, int end, const OffsetScaler& scaler,
                       const FeatureConvention& convention) {
  const auto both = [](int mm) {
    const std::uint32_t half = static_cast<std::uint16_t>(PaddedDepth::biased(mm));
    return static_cast<std::int32_t>(half << 16U | half);
  };
  const int clip = convention.clip_mm != 0 ? convention.clip_mm : 65535;
  const std::size_t count =
      depth.size() / static_cast<std::size_t>(depth.height()) * static_cast<std::size_t>(end - begin);
  for (std::vector<std::int32_t>& column : columns_) column.resize((count + kBlock - 1) / kBlock * kBlock);
  for (int v = begin; v < end; ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      const std::uint16_t depth_mm = depth(u, v);
      if (depth_mm == 0) continue;
      const OffsetScale scale = scaler.at(depth_mm);
      columns_[kU][size_] = u;
      columns_[kV][size_] = v;
      columns_[kScaleU][size_] = scale.u;
      columns_[kScaleV][size_] = scale.v;
      columns_[kLow][size_] = both(std::max(depth_mm - clip, 0));
      columns_[kHigh][size_] = both(std::min(depth_mm + clip, 65535));
      ++size_;
    }
  }
}

}  // namespace vesalius
