#include "vesalius/track/track_size.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace vesalius {
namespace {

constexpr float kMostFrames = 100.F;
constexpr float kFrameDeviation = 0.12F;  // of the logarithm of one frame's scale
constexpr float kSameDeviation = 0.05F;   // that stays however many frames there are, since poses bias it
constexpr float kFitDeviation = 0.075F;   // of the logarithm of the fitted body's size
constexpr float kScaleOfFitted = -0.04F;  // mean logarithm of body_scale over the fitted size, on rendered people
constexpr float kUnknown = std::numeric_limits<float>::infinity();

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

void TrackSize::add_scale(float scale) {
  frames_ = std::min(frames_ + 1.F, kMostFrames);
  mean_log_ += (std::log(scale) - mean_log_) / frames_;
}

void TrackSize::fit(std::optional<float> size) {
  fitted_log_.reset();
  if (size) fitted_log_ = std::log(*size) + kScaleOfFitted;
}

TrackSize::Estimate TrackSize::estimate() const {
  const float of_frame = kFrameDeviation * kFrameDeviation / std::max(frames_, 1.F);
  const float by_links = frames_ > 0.F ? 1.F / (kSameDeviation * kSameDeviation + of_frame) : 0.F;
  const float by_fit = fitted_log_ ? 1.F / (kFitDeviation * kFitDeviation) : 0.F;
  const float sum = by_links + by_fit;
  if (sum == 0.F) return {0.F, kUnknown};
  return {(by_links * mean_log_ + by_fit * fitted_log_.value_or(0.F)) / sum, 1.F / sum};
}

float TrackSize::distance2(const TrackSize& a, const TrackSize& b) {
  const Estimate one = a.estimate(), other = b.estimate();
  return (one.log - other.log) * (one.log - other.log) / (one.variance + other.variance);
}

}  // namespace vesalius
