#include "synth/sensor/stray_light.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace vesalius::synth {
namespace {

constexpr float kLeastLight = 1e-6F;

/// Replaces each number by the mean of those within `reach` in its row, of as many as there are.
void blur_rows(int reach, Image<float>& image) {
  std::vector<double> sums(static_cast<std::size_t>(image.width()) + 1);
  for (int v = 0; v < image.height(); ++v) {
    float* row = image.row(v);
    for (int u = 0; u < image.width(); ++u) sums[u + 1] = sums[u] + double(row[u]);
    for (int u = 0; u < image.width(); ++u) {
      const int from = std::max(0, u - reach), to = std::min(image.width(), u + reach + 1);
      row[u] = float((sums[to] - sums[from]) / double(to - from));
    }
  }
}

void blur_columns(int reach, Image<float>& image) {
  std::vector<double> sums(static_cast<std::size_t>(image.height()) + 1);
  for (int u = 0; u < image.width(); ++u) {
    for (int v = 0; v < image.height(); ++v) sums[v + 1] = sums[v] + double(image(u, v));
    for (int v = 0; v < image.height(); ++v) {
      const int from = std::max(0, v - reach), to = std::min(image.height(), v + reach + 1);
      image(u, v) = float((sums[to] - sums[from]) / double(to - from));
    }
  }
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
  for (Image<float>* image : {&light, &carried}) {
    blur_rows(reach, *image);
    blur_columns(reach, *image);
  }
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const float all = own[i] + share * light[i];
    if (depth[i] > 0.F && all > kLeastLight) depth[i] = (own[i] * depth[i] + share * carried[i]) / all;
  }
}

}  // namespace vesalius::synth
