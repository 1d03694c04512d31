#include "vesalius/forest/padded_depth.h"

#include <algorithm>

namespace vesalius {

PaddedDepth::PaddedDepth(const DepthImage& depth, const FeatureConvention& convention)
    : width_(depth.width()), height_(depth.height()) {
  const std::size_t stride = static_cast<std::size_t>(width_) + 1;
  values_.resize(stride * (static_cast<std::size_t>(height_) + 1) + 2);
  const std::int16_t hole = biased(convention.hole_mm);
  const std::int16_t outside = biased(convention.outside_mm);
  std::int16_t* to = values_.data() + 1;
  for (int v = 0; v < height_; ++v) {
    to = std::transform(depth.row(v), depth.row(v) + width_, to, [&](int mm) { return mm != 0 ? biased(mm) : hole; });
    *to++ = outside;
  }
  std::fill(to, values_.data() + values_.size(), outside);
}

}  // namespace vesalius
