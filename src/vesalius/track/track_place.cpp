#include "vesalius/track/track_place.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace vesalius {
namespace {

constexpr float kLeastShare = 0.15F;  // of the pixels that must be left; fewer tell nothing of the person
constexpr long kLeastPixels = 40;

/// Returns by how many millimetres a moved person's surface may lie elsewhere: a limb's swing between frames, the
/// error of a prediction, and the sensor's noise.
int tolerance_mm(int z_mm) { return 150 + int(static_cast<std::int64_t>(z_mm) * z_mm * 6 / 1'000'000); }

}  // namespace

TrackPlace::TrackPlace(const Frame& frame, const Mask& mask, const Box& box)
    : width_(mask.width()), height_(mask.height()), box_(box), mask_(crop(mask, box)), depth_(crop(frame.depth, box)) {
  pixels_ = static_cast<long>(mask_.size()) - std::count(mask_.begin(), mask_.end(), std::uint8_t{0});
  const int margin = view_margin(width_);
  at_border_ = box.u <= margin || box.v <= margin || box.u + box.width >= width_ - margin ||
               box.v + box.height >= height_ - margin;
}

float TrackPlace::unchanged(const Frame& frame) const {
  if (pixels_ == 0 || frame.depth.width() != width_ || frame.depth.height() != height_) return 0.F;
  long same = 0;
  for (int v = 0; v < box_.height; ++v) {
    for (int u = 0; u < box_.width; ++u) {
      const int now = frame.depth(box_.u + u, box_.v + v);
      if (mask_(u, v) != 0 && now != 0 && std::abs(now - depth_(u, v)) <= tolerance_mm(now)) ++same;
    }
  }
  return float(same) / float(pixels_);
}

Mask TrackPlace::expected(const Frame& frame, const Eigen::Vector3f& from, const Eigen::Vector3f& to) const {
  if (empty() || frame.depth.width() != width_ || frame.depth.height() != height_) return {};
  if (!(from.z() > 0.F) || !(to.z() > 0.F)) return {};
  const Eigen::Vector2f moved = frame.camera.pixel(to) - frame.camera.pixel(from);
  if (!(std::abs(moved.x()) < float(width_)) || !(std::abs(moved.y()) < float(height_))) return {};
  const int du = int(std::lround(moved.x())), dv = int(std::lround(moved.y()));
  const int dz_mm = int(std::lround(1e3F * (to.z() - from.z())));
  Mask out(width_, height_, 0);
  long left = 0;
  for (int v = 0; v < box_.height; ++v) {
    for (int u = 0; u < box_.width; ++u) {
      const int to_u = box_.u + u + du, to_v = box_.v + v + dv;
      if (mask_(u, v) == 0 || !out.contains(to_u, to_v)) continue;
      const int now = frame.depth(to_u, to_v), then = depth_(u, v) + dz_mm;
      if (now == 0 || std::abs(now - then) > tolerance_mm(now)) continue;
      out(to_u, to_v) = 1;
      ++left;
    }
  }
  if (left < kLeastPixels || float(left) < kLeastShare * float(pixels_)) return {};
  return out;
}

}  // namespace vesalius
