#include "vesalius/track/track_place.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

namespace vesalius {
namespace {

constexpr float kLeastShareLeft = 0.15F;  // of the pixels that must be left; fewer tell nothing of the person
constexpr long kLeastPixels = 40;

/// Returns by how many millimetres a moved person's surface may lie elsewhere: a limb's swing between frames, the
/// error of a prediction, and the sensor's noise.
int tolerance_mm(int z_mm) { return 150 + int(static_cast<std::int64_t>(z_mm) * z_mm * 6 / 1'000'000); }

constexpr float kTrunkSigma_m = 0.06F;   // of the mean of seen parts of the trunk, at one metre
constexpr float kPartsSigma_m = 0.25F;   // of what other parts predict of it, or of the mean of those seen
constexpr float kPointsSigma_m = 0.35F;  // of the mean of the mask's points
constexpr float kSigmaPerZ2 = 0.005F;

/// A mean that leaves out what is not finite.
struct Mean {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  long count = 0;

  void add(const Eigen::Vector3f& point) {
    if (!point.allFinite()) return;
    sum += point.cast<double>();
    ++count;
  }
  Eigen::Vector3f value() const { return (sum / double(count)).cast<float>(); }
};

TrunkPlace placed(const Eigen::Vector3f& position, float sigma_m) {
  return {position, sigma_m + kSigmaPerZ2 * position.z() * position.z()};
}

/// Mean of the known parts whose names end so, such as l_chest and r_chest.
Mean mean_of(const Skeleton& skeleton, const BodyModel& body, const char* ending, int& seen) {
  Mean mean;
  for (int p = 0; p < body.part_count(); ++p) {
    const SkeletonPart& part = skeleton.parts[p];
    if (part.state == State::none || !body.parts[p].name.ends_with(ending)) continue;
    mean.add(part.centre);
    seen += part.state == State::observed ? 1 : 0;
  }
  return mean;
}

Mean mean_of_points(const Person& person, const Frame& frame) {
  Mean mean;
  if (!person.mask.same_size(frame.depth)) return mean;
  for (int v = person.box.v; v < person.box.v + person.box.height; ++v) {
    for (int u = person.box.u; u < person.box.u + person.box.width; ++u) {
      if (person.mask(u, v) != 0 && frame.depth(u, v) != 0) mean.add(point_at(frame.camera, frame.depth, u, v));
    }
  }
  return mean;
}

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
  const std::optional<Eigen::Vector2i> moved = moved_pixels(frame.camera, from, to);
  if (!moved) return {};
  const int dz_mm = int(std::lround(1e3F * (to.z() - from.z())));
  Mask out(width_, height_, 0);
  long left = 0;
  for (int v = 0; v < box_.height; ++v) {
    for (int u = 0; u < box_.width; ++u) {
      const int to_u = box_.u + u + moved->x(), to_v = box_.v + v + moved->y();
      if (mask_(u, v) == 0 || !out.contains(to_u, to_v)) continue;
      const int now = frame.depth(to_u, to_v), then = depth_(u, v) + dz_mm;
      if (now == 0 || std::abs(now - then) > tolerance_mm(now)) continue;
      out(to_u, to_v) = 1;
      ++left;
    }
  }
  if (left < kLeastPixels || float(left) < kLeastShareLeft * float(pixels_)) return {};
  return out;
}

std::optional<Eigen::Vector2i> moved_pixels(const Camera& camera, const Eigen::Vector3f& from,
                                            const Eigen::Vector3f& to) {
  if (!(from.z() > 0.F) || !(to.z() > 0.F)) return std::nullopt;
  const Eigen::Vector2f moved = camera.pixel(to) - camera.pixel(from);
  if (!(std::abs(moved.x()) < float(camera.width)) || !(std::abs(moved.y()) < float(camera.height)))
    return std::nullopt;
  return Eigen::Vector2i(int(std::lround(moved.x())), int(std::lround(moved.y())));
}

std::optional<TrunkPlace> trunk_place(const Person& person, const Frame& frame, const BodyModel& body) {
  int seen = 0;
  const Mean chest = mean_of(person.skeleton, body, "chest", seen), hips = mean_of(person.skeleton, body, "hips", seen);
  if (chest.count > 0 && hips.count > 0) {
    // What is predicted from the other end is less certain, what limbs or the head alone tell still less.
    const float sigma_m = seen > 2 ? kTrunkSigma_m : seen > 0 ? 2.F * kTrunkSigma_m : kPartsSigma_m;
    return placed(0.5F * (chest.value() + hips.value()), sigma_m);
  }
  Mean parts;
  for (const SkeletonPart& part : person.skeleton.parts) {
    if (part.state == State::observed) parts.add(part.centre);
  }
  if (parts.count > 0) return placed(parts.value(), kPartsSigma_m);
  const Mean points = mean_of_points(person, frame);
  if (points.count > 0) return placed(points.value(), kPointsSigma_m);
  return std::nullopt;
}

}  // namespace vesalius
