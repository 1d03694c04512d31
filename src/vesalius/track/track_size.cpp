#include "vesalius/track/track_size.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace vesalius {
namespace {

constexpr float kMostFrames = 100.F;
constexpr float kFrameDeviation = 0.12F;  // of the logarithm of one frame's scale
constexpr float kSameDeviation = 0.05F;   // that stays however many frames there are, since poses bias it

float variance(float frames) { return kSameDeviation * kSameDeviation + kFrameDeviation * kFrameDeviation / frames; }

}  // namespace

std::optional<float> body_scale(const Skeleton& skeleton, const BodyModel& body) {
  std::vector<float> ratios;
  for (const BodyLink& link : body.links) {
    const SkeletonPart& a = skeleton.parts[link.parent];
    const SkeletonPart& b = skeleton.parts[link.child];
    if (a.state != State::observed || b.state != State::observed || link.length_m <= 0.F) continue;
    const float ratio = (a.centre - b.centre).norm() / link.length_m;
    if (std::isfinite(ratio) && ratio > 0.F) ratios.push_back(ratio);
  }
  if (ratios.size() < static_cast<std::size_t>(kLeastLinks)) return std::nullopt;
  const auto middle = ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2);
  std::ranges::nth_element(ratios, middle);
  return *middle;
}

void TrackSize::add(float scale) {
  frames_ = std::min(frames_ + 1.F, kMostFrames);
  mean_log_ += (std::log(scale) - mean_log_) / frames_;
}

float TrackSize::distance2(const TrackSize& a, const TrackSize& b) {
  if (a.frames_ == 0.F || b.frames_ == 0.F) return 0.F;
  const float off = a.mean_log_ - b.mean_log_;
  return off * off / (variance(a.frames_) + variance(b.frames_));
}

}  // namespace vesalius
