#include "synth/noise_occlusion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

namespace vesalius::synth {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();
// A slanted plane's columns are evenly spaced; rounding alone must not hide one behind its neighbour.
constexpr float kSlack_px = 1e-3F;

/// Sets all within `radius` of (u, v).
void mark_around(Mask& mask, int u, int v, int radius) {
  const int left = std::max(0, u - radius);
  const int right = std::min(mask.width() - 1, u + radius);
  for (int y = std::max(0, v - radius); y <= std::min(mask.height() - 1, v + radius); ++y) {
    std::memset(mask.row(y) + left, 1, static_cast<std::size_t>(right - left + 1));
  }
}

}  // namespace

Mask hidden_from_eye(const Image<float>& depth_m, const Camera& camera, float eye_m) {
  Mask hidden(depth_m.width(), depth_m.height(), 0);
  const float shift = camera.fx * eye_m;
  const bool to_right = eye_m > 0.F;
  for (int v = 0; v < depth_m.height(); ++v) {
    // What is near moves against the eye: walking with that motion, a column that falls behind one before is covered.
    float front = to_right ? kNothing : -kNothing;
    for (int i = 0; i < depth_m.width(); ++i) {
      const int u = to_right ? depth_m.width() - 1 - i : i;
      const float z = depth_m(u, v);
      if (z <= 0.F) continue;
      const float column = static_cast<float>(u) - shift / z;
      const bool covered = to_right ? column > front + kSlack_px : column < front - kSlack_px;
      hidden(u, v) = covered ? 1 : 0;
      front = to_right ? std::min(front, column) : std::max(front, column);
    }
  }
  return hidden;
}

Mask near_jumps(const Image<float>& depth_m, float jump_m, int radius) {
  Mask near(depth_m.width(), depth_m.height(), 0);
  const auto jumps = [&](float a, float b) { return std::abs(a - b) > jump_m || (a == 0.F) != (b == 0.F); };
  for (int v = 0; v < depth_m.height(); ++v) {
    const float* row = depth_m.row(v);
    const float* below = depth_m.row(std::min(v + 1, depth_m.height() - 1));
    for (int u = 0; u < depth_m.width(); ++u) {
      const int beside = std::min(u + 1, depth_m.width() - 1);
      if (jumps(row[u], row[beside]) || jumps(row[u], below[u])) mark_around(near, u, v, radius);
    }
  }
  return near;
}

}  // namespace vesalius::synth
