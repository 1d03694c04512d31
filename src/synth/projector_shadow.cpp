#include "synth/projector_shadow.h"

#include <cmath>
#include <limits>

namespace vesalius::synth {
namespace {

/// On the way to the projector a ray's image runs along the row, one pixel a pixel of disparity f b / z. So the ray of
/// pixel u is cut off where some u' on that side has disparity(u') - disparity(u) >= |u' - u|: where the running
/// maximum of disparity - position exceeds the pixel's own value.
class RowScan {
 public:
  RowScan(const Camera& camera, float baseline_m)
      : width_(camera.width),
        step_(baseline_m > 0.F ? -1 : 1),
        start_(baseline_m > 0.F ? camera.width - 1 : 0),
        scale_px_m_(camera.fx * std::abs(baseline_m)),
        disparity_(static_cast<std::size_t>(camera.width)) {}

  void mark(const float* depth_m, std::uint8_t* maybe) {
    constexpr float kSlackPx = 0.6F;  // less than the 1 px by which a level surface stays below its neighbour's ray
    constexpr float kStepPx = 0.5F;
    for (int u = 0; u < width_; ++u) {
      disparity_[at(u)] = depth_m[u] > 0.F ? scale_px_m_ / depth_m[u] : 0.F;
    }
    float highest = -std::numeric_limits<float>::infinity();
    for (int i = 0, u = start_; i < width_; ++i, u += step_) {
      if (!(depth_m[u] > 0.F)) continue;
      const float value = disparity_[at(u)] + static_cast<float>(i);
      const bool leaves = static_cast<float>(i) < scale_px_m_ / kNearestBlocker_m - disparity_[at(u)];
      const bool step = i > 0 && std::abs(disparity_[at(u - step_)] - disparity_[at(u)]) > kStepPx;
      if (leaves || step || highest >= value - kSlackPx) maybe[u] = 1;
      highest = std::max(highest, value);
    }
  }

 private:
  static constexpr float kNearestBlocker_m = 0.5F;  ///< beside the picture
  static std::size_t at(int u) { return static_cast<std::size_t>(u); }

  int width_, step_, start_;
  float scale_px_m_;
  std::vector<float> disparity_;
};

/// Where a shadow ends within a pixel is for the neighbours to say.
void widen(const Mask& marked, const Image<float>& depth_m, Mask& wide) {
  constexpr int kReach = 2;
  for (int v = 0; v < marked.height(); ++v) {
    for (int u = 0; u < marked.width(); ++u) {
      if (marked(u, v) == 0) continue;
      for (int x = std::max(0, u - kReach); x <= std::min(marked.width() - 1, u + kReach); ++x) {
        if (depth_m(x, v) > 0.F) wide(x, v) = 1;
      }
    }
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
