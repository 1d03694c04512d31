#include "vesalius/track/track_look.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "vesalius/base/pixel_grid.h"

namespace vesalius {
namespace {

constexpr float kLookKept = 0.95F;  // share of what is known that stays as a frame is added: half of it in 14 frames
constexpr long kLeastLookSamples = 150;
constexpr int kMargin = 4;  // pixels of the grid, so that textures at the box's rim are seen as in the whole picture

/// Returns the box with a margin around, its corner on the grid, as far as the picture goes.
Box around(const Box& box, int step, const Mask& picture) {
  const int left = std::max(0, box.u - kMargin * step) / step * step;
  const int top = std::max(0, box.v - kMargin * step) / step * step;
  const int right = std::min(picture.width(), box.u + box.width + kMargin * step);
  const int bottom = std::min(picture.height(), box.v + box.height + kMargin * step);
  return {left, top, right - left, bottom - top};
}

constexpr float kMostFrames = 100.F;
constexpr float kFrameDeviation = 0.12F;  // of the logarithm of one frame's scale
constexpr float kSameDeviation = 0.05F;   // that stays however many frames there are, since poses bias it
constexpr float kFitDeviation = 0.075F;   // of the logarithm of the fitted body's size
constexpr float kScaleOfFitted = -0.04F;  // mean logarithm of body_scale over the fitted size, on rendered people
constexpr float kUnknown = std::numeric_limits<float>::infinity();

}  // namespace

AppearanceHistogram look_of(const Frame& frame, const Mask& mask, const Box& box, const Appearance* appearance) {
  if (appearance == nullptr || box.width <= 0 || box.height <= 0) return {};
  const int step = grid_step(frame.camera, {});
  const Box part = around(box, step, mask);
  Frame cut;
  cut.camera = cropped(frame.camera, part);
  cut.depth = crop(frame.depth, part);
  if (!frame.colour.empty()) cut.colour = crop(frame.colour, part);
  const Mask inside = crop(mask, part);
  return step == 1 ? learn_appearance(cut, inside, *appearance)
                   : learn_appearance(every_nth(cut, step), every_nth(inside, step), *appearance);
}

void TrackLook::add_histogram(const AppearanceHistogram& frame) {
  if (frame.samples() == 0) return;
  histogram_.scale(kLookKept);
  histogram_.add(frame);
}

std::optional<float> look_distance(const AppearanceHistogram& a, const AppearanceHistogram& b,
                                   const Appearance* appearance) {
  if (appearance == nullptr || std::min(a.samples(), b.samples()) < kLeastLookSamples) return std::nullopt;
  const std::vector<float> p = a.probabilities(*appearance), q = b.probabilities(*appearance);
  double shared = 0.0;
  for (std::size_t i = 0; i < std::min(p.size(), q.size()); ++i) shared += std::sqrt(double(p[i] * q[i]));
  return float(-std::log(std::clamp(shared, 1e-6, 1.0)));
}

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
