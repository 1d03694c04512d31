#include "synth/sensor/stray_light.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace vesalius::synth {
namespace {

constexpr float kLeastLight = 1e-6F;

/// Replaces each number of a row (step 1) or column by the mean of those within `reach`, of as many as there are.
void blur_line(float* line, std::ptrdiff_t step, int count, int reach, std::vector<double>& sums) {
  sums.assign(static_cast<std::size_t>(count) + 1, 0.0);
  for (int i = 0; i < count; ++i) sums[i + 1] = sums[i] + double(line[i * step]);
  for (int i = 0; i < count; ++i) {
    const int from = std::max(0, i - reach), to = std::min(count, i + reach + 1);
    line[i * step] = float((sums[to] - sums[from]) / double(to - from));
  }
}

void blur(int reach, Image<float>& image) {
  const int width = image.width(), height = image.height();
  std::vector<double> sums;
  for (int v = 0; v < height; ++v) blur_line(image.row(v), 1, width, reach, sums);
  for (int u = 0; u < width; ++u) blur_line(image.row(0) + u, width, height, reach, sums);
}

}  // namespace

void add_stray_light(float share, Rendering& rendering) {
  if (share <= 0.F) return;
  Image<float>& depth = rendering.depth_m;
  Image<float> light(depth.width(), depth.height(), 0.F), carried(depth.width(), depth.height(), 0.F);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (depth[i] <= 0.F) continue;
    light[i] = rendering.infrared[i] / (depth[i] * depth[i]);
    carried[i] = light[i] * depth[i];
  }
  const Image<float> own = light;
  const int reach = std::max(1, depth.width() / 8);
  blur(reach, light);
  blur(reach, carried);
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const float all = own[i] + share * light[i];
    if (depth[i] > 0.F && all > kLeastLight) depth[i] = (own[i] * depth[i] + share * carried[i]) / all;
  }
}

}  // namespace vesalius::synth
