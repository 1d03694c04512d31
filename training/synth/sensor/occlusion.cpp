#include "synth/sensor/occlusion.h"

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

/// Finds shadows along a row. On its way to the projector the image of a ray runs along the row, one pixel for each
/// pixel of disparity f b / z. So the ray of pixel u is blocked if some u' on that side has disparity(u') -
/// disparity(u) >= |u' - u|, which means that the running maximum of disparity - position exceeds the pixel's own
/// value.
class RowScan {
 public:
  RowScan(const Camera& camera, float baseline_m)
      : width_(camera.width),
        step_(baseline_m > 0.F ? -1 : 1),
        start_(baseline_m > 0.F ? camera.width - 1 : 0),
        scale_px_m_(camera.fx * std::abs(baseline_m)),
        disparity_(camera.width) {}

  void mark(const float* depth_m, std::uint8_t* maybe) {
    constexpr float kSlackPx = 0.6F;  // less than the 1 px by which a flat surface stays below its neighbour's ray
    constexpr float kStepPx = 0.5F;
    constexpr float kFar = std::numeric_limits<float>::infinity();
    for (int u = 0; u < width_; ++u) disparity_[at(u)] = scale_px_m_ / (depth_m[u] > 0.F ? depth_m[u] : kFar);
    float highest = -kFar;
    float before = disparity_[at(start_)];
    for (int i = 0, u = start_; i < width_; ++i, u += step_) {
      const float here = disparity_[at(u)];
      const bool step = std::abs(before - here) > kStepPx;
      before = here;
      if (!(depth_m[u] > 0.F)) continue;
      const float value = here + float(i);
      const bool leaves = float(i) < scale_px_m_ / kNearestBlocker_m - here;
      maybe[u] = static_cast<std::uint8_t>(static_cast<unsigned>(leaves) | static_cast<unsigned>(step) |
                                           static_cast<unsigned>(highest >= value - kSlackPx));
      highest = std::max(highest, value);
    }
  }

 private:
  static constexpr float kNearestBlocker_m = 0.5F;  ///< nearest blocker outside the picture
  static std::size_t at(int u) { return static_cast<std::size_t>(u); }

  int width_, step_, start_;
  float scale_px_m_;
  std::vector<float> disparity_;
};

/// Marks the neighbours of marked pixels, since a shadow may end within a pixel.
void widen(const Mask& marked, const Image<float>& depth_m, Mask& wide) {
  constexpr int kReach = 2;
  const int width = marked.width();
  for (int v = 0; v < marked.height(); ++v) {
    const std::uint8_t* in = marked.row(v);
    const float* depth = depth_m.row(v);
    std::uint8_t* out = wide.row(v);
    for (int shift = 1; shift <= std::min(kReach, width - 1); ++shift) {
      for (int u = 0; u < width - shift; ++u) out[u] |= in[u + shift];
      for (int u = shift; u < width; ++u) out[u] |= in[u - shift];
    }
    for (int u = 0; u < width; ++u) out[u] = depth[u] > 0.F ? out[u] : std::uint8_t{0};
  }
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

Mask maybe_shaded(const Image<float>& depth_m, const Camera& camera, float baseline_m) {
  Mask marked(depth_m.width(), depth_m.height());
  RowScan scan(camera, baseline_m);
  for (int v = 0; v < depth_m.height(); ++v) scan.mark(depth_m.row(v), marked.row(v));
  Mask wide = marked;
  widen(marked, depth_m, wide);
  return wide;
}

}  // namespace vesalius::synth
