#include "synth/sensor/projector_shadow.h"

#include <cmath>
#include <limits>

namespace vesalius::synth {
namespace {

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

Mask maybe_shaded(const Image<float>& depth_m, const Camera& camera, float baseline_m) {
  Mask marked(depth_m.width(), depth_m.height());
  RowScan scan(camera, baseline_m);
  for (int v = 0; v < depth_m.height(); ++v) scan.mark(depth_m.row(v), marked.row(v));
  Mask wide = marked;
  widen(marked, depth_m, wide);
  return wide;
}

}  // namespace vesalius::synth
