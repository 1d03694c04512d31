#include "vesalius/forest/background_gate.h"

#include <algorithm>
#include <cmath>

#include "vesalius/base/pixel_grid.h"

namespace vesalius {
bool take_from_grid(const DepthImage& depth, int step, int u, int v, Posteriors& out) {
  const GridPixel nearest = nearest_on_grid(depth, step, u, v, BackgroundGate::kGuideMm);
  if (nearest.found) std::copy_n(out.at(nearest.u, nearest.v), out.classes, out.at(u, v));
  return nearest.found;
}

long BackgroundGate::enough(float least, int whole) { return static_cast<long>(std::ceil(least * float(whole))); }

BackgroundGate::BackgroundGate(const DepthImage& depth, const Posteriors& posteriors, float least)
    : width_(depth.width()),
      states_((depth.width() + kStep - 1) / kStep, (depth.height() + kStep - 1) / kStep, kNoReading) {
  const long certain = enough(least, posteriors.whole);
  for (int j = 0; j < states_.height(); ++j) {
    for (int i = 0; i < states_.width(); ++i) {
      const int u = i * kStep, v = j * kStep;
      if (depth(u, v) == 0) continue;
      states_(i, j) = posteriors.at(u, v)[posteriors.classes - 1] >= certain ? kSure : kUnsure;
    }
  }
}

void BackgroundGate::row(int v, std::uint8_t* shut) const {
  const std::uint8_t* above = states_.row(v / kStep);
  const std::uint8_t* below = states_.row(std::min((v + kStep - 1) / kStep, states_.height() - 1));
  const auto column = [&](int i) { return static_cast<std::uint8_t>(above[i] | below[i]); };
  for (int u = 0; u < width_; ++u) {
    const int next = std::min((u + kStep - 1) / kStep, states_.width() - 1);
    shut[u] = (column(u / kStep) | column(next)) == kSure ? 1 : 0;
  }
}

}  // namespace vesalius
