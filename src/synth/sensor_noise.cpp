#include "synth/sensor_noise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "synth/noise_aim.h"
#include "synth/noise_angle.h"
#include "synth/noise_field.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using Array = Eigen::ArrayXf;

constexpr float kHalfPi = 1.57079633F;
// Nguyen et al. 2012: axial sigma += 0.0001 / sqrt(z) t^2, t = angle / (pi/2 - angle), cut where it grows without
// bound.
constexpr float kGrazing = 0.0001F;
constexpr float kLargestAngle = 1.55F;
constexpr float kDarkReference_m = 2.F;  // where Sensor::min_infrared holds
// How fast readings vanish, in sigma of the noise that decides: per doubling of the signal, per radian.
constexpr float kKeptPerDoubling = 1.2F;
constexpr float kKeptPerRad = 1.F / 0.052F;  // 3 degrees
// A hole's rim is rough: share of the deciding noise that is independent from pixel to pixel.
constexpr float kLossGrain = 0.08F;
// Holes are larger than what errors hang together over.
constexpr float kLossWindows = 2.F;
constexpr float kNearest_m = 0.1F;
constexpr float kSmallestAmplitude = 1e-4F;
constexpr float kPerLog2 = 1.44269504F;  // 1 / ln 2

Border draw_border(const Sensor& sensor, Random& random) {
  const auto draw = [&](int low, int high) {
    return low + static_cast<int>(random.below(static_cast<std::uint32_t>(std::max(0, high - low)) + 1));
  };
  const Border& a = sensor.border_low;
  const Border& b = sensor.border_high;
  Border border;
  border.left = draw(a.left, b.left);
  border.right = draw(a.right, b.right);
  border.top = draw(a.top, b.top);
  border.bottom = draw(a.bottom, b.bottom);
  return border;
}

void check_sizes(const Rendering& rendering, const Sensor& sensor) {
  const auto& depth = rendering.depth_m;
  const auto fits = [&](const auto& image) { return image.same_size(depth); };
  if (depth.empty() || !fits(rendering.normal) || !fits(rendering.infrared)) {
    throw Error("rendering: expected depth, normals and infrared of one size");
  }
  if (!fits(rendering.lit) && (projector_of(sensor) || !rendering.lit.empty())) {
    throw Error(fmt::format("rendering: sensor {}: expected the picture of what its projector lights", sensor.name));
  }
}

std::uint16_t millimetres(const Sensor& sensor, float z_m) {
  if (!(z_m >= sensor.near_m && z_m <= sensor.far_m)) return 0;
  return static_cast<std::uint16_t>(std::min(65535.F, z_m * 1000.F + 0.5F));
}

/// One frame being read, row by row.
class Reading {
 public:
  Reading(const Rendering& rendering, const Sensor& sensor, Random& random);
  DepthImage run(Image<std::uint32_t>* source);

 private:
  const Array& losses(int v);
  const Array& errors(int v);
  Array kept(const AimedRow& row, const Array& angle) const;
  Array measured(const AimedRow& row, const Array& angle, const Array& error) const;
  Array structured_light(const Array& z, const Array& angle, const Array& error) const;
  Array stereo(const Array& z, const Array& error) const;
  Array time_of_flight(const AimedRow& row, const Array& error) const;
  Array quantised(const Array& disparity_px) const;
  Array axial_sigma(const Array& z) const {
    return sensor_.axial_base_m + sensor_.axial_z2 * (z - sensor_.axial_z0_m).square();
  }

  const Sensor& sensor_;
  Random& random_;
  int width_, height_;
  Border border_;
  Aim aim_;
  NoiseField error_, loss_;
  Array white_, grainy_;  ///< scratch
};

Reading::Reading(const Rendering& rendering, const Sensor& sensor, Random& random)
    : sensor_(sensor),
      random_(random),
      width_(rendering.depth_m.width()),
      height_(rendering.depth_m.height()),
      border_(draw_border(sensor, random)),
      aim_(rendering, sensor, random),
      error_(width_, height_, sensor.window_px, random),
      loss_(width_, height_, kLossWindows * sensor.window_px, random),
      white_(width_),
      grainy_(width_) {}

DepthImage Reading::run(Image<std::uint32_t>* source) {
  DepthImage depth(width_, height_, 0);
  for (int v = border_.top; v < height_ - border_.bottom; ++v) {
    const Array& loss = losses(v);
    const AimedRow& row = aim_.row(v, loss);
    const Array angle = angle_of(row.cosine);
    const Array keep = kept(row, angle);
    const Array z = measured(row, angle, errors(v));
    for (int u = border_.left; u < width_ - border_.right; ++u) {
      if (row.z[u] == 0.F || loss[u] > keep[u]) continue;
      depth(u, v) = millimetres(sensor_, z[u]);
      if (source != nullptr && depth(u, v) != 0) (*source)(u, v) = row.source[static_cast<std::size_t>(u)];
    }
  }
  return depth;
}

/// Normal noise that decides which readings are lost: smooth, so that holes are blotches, with rough rims.
const Array& Reading::losses(int v) {
  for (float& value : grainy_) value = kLossGrain * quick_normal(random_);
  grainy_ += std::sqrt(1.F - kLossGrain * kLossGrain) * loss_.row(v);
  return grainy_;
}

/// Normal noise of the depth: alike within a matching window; with time of flight each pixel measures for itself.
const Array& Reading::errors(int v) {
  if (sensor_.kind != SensorKind::time_of_flight) return error_.row(v);
  for (float& value : white_) value = quick_normal(random_);
  return white_;
}

/// Largest loss noise at which there still is a reading: the surface must send back enough light and not be too flat.
Array Reading::kept(const AimedRow& row, const Array& angle) const {
  const Array signal = row.infrared * row.cosine * row.fall_off * (kDarkReference_m / row.z).square();
  const Array doublings = (signal * (1.F / sensor_.min_infrared)).log() * kPerLog2;
  return (kKeptPerDoubling * doublings).min((sensor_.max_angle_rad - angle) * kKeptPerRad);
}

/// Metres; 0 = no reading.
Array Reading::measured(const AimedRow& row, const Array& angle, const Array& error) const {
  switch (sensor_.kind) {
    case SensorKind::structured_light:
      return structured_light(row.z, angle, error);
    case SensorKind::stereo:
      return stereo(row.z, error);
    default:
      return time_of_flight(row, error);
  }
}

Array Reading::structured_light(const Array& z, const Array& angle, const Array& error) const {
  const Array limited = angle.min(kLargestAngle);
  const Array t = limited / (kHalfPi - limited);
  const Array sigma = axial_sigma(z) + kGrazing * z.sqrt().inverse() * t.square();
  // The formula was measured behind the quantisation, whose share must not count twice.
  const Array step = z.square() * (sensor_.disparity_step_px / sensor_.disparity_px_m);
  const Array before = (sigma.square() - step.square() / 12.F).max(0.F).sqrt();
  return quantised(sensor_.disparity_px_m / (z + before * error).max(kNearest_m));
}

Array Reading::stereo(const Array& z, const Array& error) const {
  return quantised(sensor_.disparity_px_m / z + sensor_.matching_px * error);
}

Array Reading::time_of_flight(const AimedRow& row, const Array& error) const {
  const Array amplitude = (row.infrared * row.cosine * row.fall_off).max(kSmallestAmplitude);
  return row.z + (axial_sigma(row.z) + sensor_.amplitude_z2 * row.z.square() / amplitude) * error;
}

/// Depth of disparities that come in steps.
Array Reading::quantised(const Array& disparity_px) const {
  const float step = sensor_.disparity_step_px;
  return sensor_.disparity_px_m / ((disparity_px * (1.F / step) + 0.5F).floor() * step);
}

}  // namespace

std::optional<Eigen::Vector3f> projector_of(const Sensor& sensor) {
  if (sensor.baseline_m == 0.F || sensor.kind == SensorKind::perfect) return std::nullopt;
  return Eigen::Vector3f(sensor.baseline_m, 0.F, 0.F);
}

DepthImage sense(const Rendering& rendering, const Sensor& sensor, Random random, Image<std::uint32_t>* source) {
  check_sizes(rendering, sensor);
  const auto& depth_m = rendering.depth_m;
  if (source != nullptr) {
    *source = Image<std::uint32_t>(depth_m.width(), depth_m.height());
    std::iota(source->begin(), source->end(), std::uint32_t{0});
  }
  if (sensor.kind != SensorKind::perfect) return Reading(rendering, sensor, random).run(source);
  DepthImage depth(depth_m.width(), depth_m.height());
  std::transform(depth_m.begin(), depth_m.end(), depth.begin(), [&](float z) { return millimetres(sensor, z); });
  return depth;
}

}  // namespace vesalius::synth
