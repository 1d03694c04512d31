#include "synth/sensor/noise_occlusion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace vesalius::synth {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();
// The columns of a slanted plane are evenly spaced, and rounding alone must not hide one behind its neighbour.
constexpr float kSlack_px = 1e-3F;

/// Joins each pixel with all within `radius` of it, first to left and right and then up and down.
template <class T, class Join>
Image<T> spread(const Image<T>& image, int radius, Join join) {
  const int width = image.width(), height = image.height();
  const auto join_row = [&](const T* in, T* out, int count) {
    for (int i = 0; i < count; ++i) out[i] = join(out[i], in[i]);
  };
  Image<T> level = image;
  for (int v = 0; v < height; ++v) {
    for (int shift = 1; shift <= std::min(radius, width - 1); ++shift) {
      join_row(image.row(v) + shift, level.row(v), width - shift);
      join_row(image.row(v), level.row(v) + shift, width - shift);
    }
  }
  Image<T> all = level;
  for (int v = 0; v < height; ++v) {
    for (int y = std::max(0, v - radius); y <= std::min(height - 1, v + radius); ++y) {
      if (y != v) join_row(level.row(y), all.row(v), width);
    }
  }
  return all;
}

}  // namespace

Mask hidden_from_eye(const Image<float>& depth_m, const Camera& camera, float eye_m) {
  Mask hidden(depth_m.width(), depth_m.height(), 0);
  const float shift = camera.fx * eye_m;
  const bool to_right = eye_m > 0.F;
  for (int v = 0; v < depth_m.height(); ++v) {
    // Near surfaces shift against the eye's motion. Going along that shift, a column that falls behind an earlier one
    // is hidden.
    float front = to_right ? kNothing : -kNothing;
    const float* row = depth_m.row(v);
    std::uint8_t* out = hidden.row(v);
    for (int i = 0; i < depth_m.width(); ++i) {
      const int u = to_right ? depth_m.width() - 1 - i : i;
      if (row[u] <= 0.F) continue;
      const float column = float(u) - shift / row[u];
      out[u] = (to_right ? column > front + kSlack_px : column < front - kSlack_px) ? 1 : 0;
      front = to_right ? std::min(front, column) : std::max(front, column);
    }
  }
  return hidden;
}

Mask near_jumps(const Image<float>& depth_m, float jump_m, int radius) {
  const int width = depth_m.width();
  Mask jumping(width, depth_m.height(), 0);
  const auto jumps = [&](float a, float b) {
    return static_cast<std::uint8_t>((std::abs(a - b) > jump_m) | ((a == 0.F) != (b == 0.F)));
  };
  for (int v = 0; v < depth_m.height(); ++v) {
    const float* row = depth_m.row(v);
    const float* below = depth_m.row(std::min(v + 1, depth_m.height() - 1));
    std::uint8_t* out = jumping.row(v);
    for (int u = 0; u + 1 < width; ++u) out[u] = jumps(row[u], row[u + 1]) | jumps(row[u], below[u]);
    out[width - 1] = jumps(row[width - 1], below[width - 1]);
  }
  return spread(jumping, radius, [](std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>(a | b); });
}

Image<float> nearest_within(const Image<float>& depth_m, int radius) {
  Image<float> surfaces = depth_m;
  for (float& z : surfaces) z = z > 0.F ? z : kNothing;
  return spread(surfaces, radius, [](float a, float b) { return b < a ? b : a; });
}

}  // namespace vesalius::synth
