#include "synth/sensor/sensor_noise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "synth/sensor/noise_aim.h"
#include "synth/sensor/noise_field.h"
#include "synth/sensor/noise_kernel.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using Array = Eigen::ArrayXf;

// Share of the deciding noise that is independent from pixel to pixel, which makes the rims of holes rough.
constexpr float kLossGrain = 0.08F;
// Size of holes in windows: they are larger than the window within which errors are correlated.
constexpr float kLossWindows = 2.F;

Border draw_border(const Sensor& sensor, Random& random) {
  const auto draw = [&](int low, int high) { return low + int(random.below(std::max(0, high - low) + 1)); };
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

/// Reads one frame row by row.
class Reading {
 public:
  Reading(const Rendering& rendering, const Sensor& sensor, Random& random);
  DepthImage run(Image<std::uint32_t>* source);

 private:
  const Array& losses(int v);
  const Array& errors(int v);

  const Sensor& sensor_;
  Random& random_;
  int width_, height_;
  Border border_;
  Aim aim_;
  NoiseField error_, loss_;
  Array white_, grainy_;  ///< temporary memory, padded
  std::vector<std::uint16_t> read_mm_;
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
      white_(Array::Zero(padded_width(width_))),
      grainy_(Array::Zero(padded_width(width_))),
      read_mm_(padded_width(width_)) {}

DepthImage Reading::run(Image<std::uint32_t>* source) {
  DepthImage depth(width_, height_, 0);
  const auto at = [](int u) { return static_cast<std::size_t>(u); };
  const int right = std::max(border_.left, width_ - border_.right);
  for (int v = border_.top; v < height_ - border_.bottom; ++v) {
    const Array& loss = losses(v);
    const AimedRow& row = aim_.row(v, loss);
    read_row(sensor_,
             {row.z.data(), row.cosine.data(), row.infrared.data(), row.fall_off.data(), loss.data(), errors(v).data()},
             width_, read_mm_.data());
    std::copy(read_mm_.begin() + border_.left, read_mm_.begin() + right, depth.row(v) + border_.left);
    if (source == nullptr) continue;
    std::uint32_t* from = source->row(v);
    for (int u = border_.left; u < right; ++u) from[u] = read_mm_[at(u)] != 0 ? row.source[at(u)] : from[u];
  }
  return depth;
}

/// Returns the normal noise that decides which readings are lost. It is smooth, so holes are blotches; a share of
/// independent noise makes their rims rough.
const Array& Reading::losses(int v) {
  const float smooth = std::sqrt(1.F - kLossGrain * kLossGrain);
  const Array& field = loss_.row(v);
  for (int u = 0; u < width_; ++u) grainy_[u] = kLossGrain * quick_normal(random_) + smooth * field[u];
  return grainy_;
}

/// Returns the normal noise of the depth. It is correlated within a matching window; with time of flight each pixel is
/// independent.
const Array& Reading::errors(int v) {
  if (sensor_.kind != SensorKind::time_of_flight) return error_.row(v);
  std::generate_n(white_.data(), width_, [&] { return quick_normal(random_); });
  return white_;
}

}  // namespace

std::optional<Eigen::Vector3f> projector_of(const Sensor& sensor) {
  if (sensor.baseline_m == 0.F || sensor.kind == SensorKind::perfect) return std::nullopt;
  return Eigen::Vector3f(sensor.baseline_m, 0.F, 0.F);
}

void settle_border(Sensor& sensor, Random random) {
  sensor.border_low = sensor.border_high = draw_border(sensor, random);
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
