#include "synth/sensor/sensor_noise.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "synth/sensor/camera_rays.h"
#include "synth/sensor/noise_field.h"
#include "synth/sensor/noise_kernel.h"
#include "synth/sensor/occlusion.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using Array = Eigen::ArrayXf;

constexpr float kHalfPi = 1.57079633F;
constexpr float kLateralGrowth = 0.035F / 0.8F;  // Nguyen et al. 2012: sigma = 0.8 + 0.035 angle / (pi/2 - angle) px
constexpr float kSmallestJump_m = 0.08F;
constexpr float kFurthestJitter = 3.F;  // sigma
constexpr float kSmallestLight = 1e-6F;

/// Returns x such that P(normal > x) = p.
float exceeded_by(float p) {
  float low = -5.F;
  float high = 5.F;
  for (int i = 0; i < 30; ++i) {
    const float middle = 0.5F * (low + high);
    (0.5F * std::erfc(middle * 0.70710678F) > p ? low : high) = middle;
  }
  return low;
}

/// Rounds halves away from zero, as std::lround() does. A call of that would cost more than everything else here.
int whole_px(float pixels) { return int(pixels + std::copysign(0.5F, pixels)); }

float angle_of(float c) {
  const auto& a = kAngleSeries;
  return std::sqrt(1.F - c) * (a[0] + c * (a[1] + c * (a[2] + a[3] * c)));
}

/// Returns the distance at which a silhouette has an effect.
int influence_px(const Sensor& sensor, int reach_px) {
  return std::max({1, reach_px, int(std::ceil(kFurthestJitter * sensor.lateral_px))});
}

/// Returns the depth of the surfaces that both the sensor's light and its eye reach; 0 elsewhere.
Image<float> seen_depth(const Rendering& rendering, const Sensor& sensor) {
  Image<float> seen = rendering.depth_m;
  for (std::size_t i = 0; i < rendering.lit.size(); ++i) seen[i] = rendering.lit[i] != 0 ? seen[i] : 0.F;
  if (sensor.eye_m == 0.F) return seen;
  const Mask hidden = hidden_from_eye(rendering.depth_m, rendering.view.camera, sensor.eye_m);
  for (std::size_t i = 0; i < hidden.size(); ++i) seen[i] = hidden[i] == 0 ? seen[i] : 0.F;
  return seen;
}

/// The surfaces that the pixels of one row of a sensor read, as padded arrays for the formulas that follow
/// (noise_kernel.h).
struct AimedRow {
  Array z;         ///< metres; 0: nothing
  Array cosine;    ///< cosine of the angle between ray and normal, kSmallestCosine to 1
  Array infrared;  ///< share of light sent back
  Array fall_off;  ///< fourth power of the cosine between ray and optical axis: share of light off the axis
  std::vector<std::uint32_t> source;  ///< pixel of the rendering, row-major
};

/// Finds the surface that each pixel of a sensor reads: jittered across the image plane, foreground grown over what is
/// behind it, shadows of projector and eye as holes, background thinned out along silhouettes, near and far mixed.
class Aim {
 public:
  /// Keeps references to all three.
  Aim(const Rendering& rendering, const Sensor& sensor, Random& random);

  /// Returns what row v reads. `losses` is normal noise that decides where the background is lost.
  const AimedRow& row(int v, const Array& losses);

 private:
  struct Spot {
    int u = 0, v = 0;  ///< pixel of the rendering
    std::uint32_t at = 0;
    float z = 0.F;  ///< 0: no surface
    float cosine = 1.F;
  };

  Spot look(int u, int v) const;
  float amplitude(const Spot& spot) const { return in_.infrared[spot.at] * spot.cosine; }
  float slope_m(const Spot& spot, float distance_px) const;
  bool beyond_silhouette(const Spot& spot) const;
  Spot displaced(const Spot& spot) const;
  Spot grown(const Spot& spot) const;
  Spot at_silhouette(const Spot& spot, float loss);
  Spot across_silhouette(const Spot& spot) const;
  Spot mixed(const Spot& spot);

  const Rendering& in_;
  const Sensor& sensor_;
  Random& random_;
  int width_, height_;
  CameraRays rays_;
  int fatten_px_, reach_px_;
  float edge_threshold_;
  Image<float> seen_m_;  ///< depth of what light and eye both reach, 0 elsewhere
  Mask near_silhouette_;
  Image<float> nearest_m_;  ///< depth of the nearest surface within reach
  NoiseField shift_u_, shift_v_;
  AimedRow row_;
};

Aim::Aim(const Rendering& rendering, const Sensor& sensor, Random& random)
    : in_(rendering),
      sensor_(sensor),
      random_(random),
      width_(rendering.depth_m.width()),
      height_(rendering.depth_m.height()),
      rays_(rendering.view.camera),
      fatten_px_(whole_px(sensor.fatten_px)),
      reach_px_(std::max(whole_px(sensor.edge_px), fatten_px_)),
      edge_threshold_(exceeded_by(sensor.edge_loss)),
      seen_m_(seen_depth(rendering, sensor)),
      near_silhouette_(near_jumps(seen_m_, kSmallestJump_m, influence_px(sensor, reach_px_))),
      nearest_m_(nearest_within(rendering.depth_m, reach_px_)),
      shift_u_(width_, height_, sensor.window_px, random),
      shift_v_(shift_u_, random) {
  for (Array* padded : {&row_.z, &row_.cosine, &row_.infrared, &row_.fall_off}) {
    *padded = Array::Zero(padded_width(width_));
  }
  row_.source.resize(width_);
}

const AimedRow& Aim::row(int v, const Array& losses) {
  face_row(in_.normal.row(v), rays_.x(), rays_.y(v), width_, row_.cosine.data(), row_.fall_off.data());
  std::copy_n(in_.infrared.row(v), width_, row_.infrared.data());
  std::copy_n(seen_m_.row(v), width_, row_.z.data());
  std::iota(row_.source.begin(), row_.source.end(), static_cast<std::uint32_t>(v * width_));
  const std::uint8_t* near = near_silhouette_.row(v);
  for (int u = 0; u < width_; ++u) {
    if (near[u] == 0) continue;
    const Spot own{u, v, row_.source[u], in_.depth_m(u, v), row_.cosine[u]};
    const Spot spot = at_silhouette(displaced(own), losses[u]);
    row_.z[u] = spot.z;
    if (spot.z == 0.F) continue;
    row_.source[u] = spot.at;
    row_.cosine[u] = spot.cosine;
    row_.infrared[u] = in_.infrared[spot.at];
  }
  return row_;
}

Aim::Spot Aim::look(int u, int v) const {
  const float x = rays_.x(u), y = rays_.y(v);
  const auto at = static_cast<std::uint32_t>(v * width_ + u);
  const Eigen::Vector3f& normal = in_.normal[at];
  const float facing = -(normal.x() * x + normal.y() * y + normal.z()) / std::sqrt(x * x + y * y + 1.F);
  return {u, v, at, in_.depth_m[at], std::clamp(facing, kSmallestCosine, 1.F)};
}

/// Returns how much the depth of a continuous surface can change within `distance_px`.
float Aim::slope_m(const Spot& spot, float distance_px) const {
  const float c = spot.cosine;
  return kSmallestJump_m + 2.F * distance_px * spot.z / in_.view.camera.fx * std::sqrt(1.F - c * c) / c;
}

/// Returns the spot that is read instead. The read-out position jitters, and with it every silhouette. A continuous
/// surface stays in place, because its axial noise was measured with the jitter included.
Aim::Spot Aim::displaced(const Spot& spot) const {
  if (sensor_.lateral_px == 0.F) return spot;
  const float angle = angle_of(spot.cosine);
  const float sigma_px = sensor_.lateral_px * (1.F + kLateralGrowth * angle / (kHalfPi - angle));
  const int du = whole_px(sigma_px * shift_u_.at(spot.u, spot.v));
  const int dv = whole_px(sigma_px * shift_v_.at(spot.u, spot.v));
  if ((du == 0 && dv == 0) || !in_.depth_m.contains(spot.u + du, spot.v + dv)) return spot;
  const float z = in_.depth_m(spot.u + du, spot.v + dv);
  const auto furthest_px = float(std::abs(du) + std::abs(dv));
  const bool goes_on = z > 0.F && spot.z > 0.F && std::abs(z - spot.z) < slope_m(spot, furthest_px);
  return goes_on ? spot : look(spot.u + du, spot.v + dv);
}

/// Returns whether a surface within reach is nearer than the slope of this one explains.
bool Aim::beyond_silhouette(const Spot& spot) const {
  const float limit = spot.z > 0.F ? spot.z - slope_m(spot, float(reach_px_)) : std::numeric_limits<float>::max();
  return nearest_m_[spot.at] < limit;
}

/// Returns the nearest surface that the matching window around the spot covers. It hides surfaces behind it and fills
/// the rim of a shadow. Returns no surface if the window covers none.
Aim::Spot Aim::grown(const Spot& spot) const {
  const bool seen = seen_m_[spot.at] > 0.F;
  float nearest = seen ? spot.z - kSmallestJump_m : std::numeric_limits<float>::max();
  std::pair<int, int> best(-1, -1);
  for (int v = std::max(0, spot.v - fatten_px_); v <= std::min(height_ - 1, spot.v + fatten_px_); ++v) {
    for (int u = std::max(0, spot.u - fatten_px_); u <= std::min(width_ - 1, spot.u + fatten_px_); ++u) {
      const float z = seen_m_(u, v);
      if (z == 0.F || z >= nearest) continue;
      nearest = z;
      best = {u, v};
    }
  }
  if (best.first >= 0) return look(best.first, best.second);
  return seen ? spot : Spot{};
}

/// Returns the spot that is read near a silhouette, where a nearer surface may grow over it or its rim may be lost.
Aim::Spot Aim::at_silhouette(const Spot& spot, float loss) {
  const bool beyond = beyond_silhouette(spot);
  const Spot read = beyond || seen_m_[spot.at] == 0.F ? grown(spot) : spot;
  if (read.z == 0.F) return read;
  if (beyond && read.at == spot.at && loss > edge_threshold_) return {};
  return sensor_.mixed_px > 0.F ? mixed(read) : read;
}

/// Returns that of the four neighbours whose depth differs most, if by more than 8 cm; otherwise no surface.
Aim::Spot Aim::across_silhouette(const Spot& spot) const {
  Spot other;
  float widest = kSmallestJump_m;
  for (const auto& [du, dv] : {std::pair(-1, 0), std::pair(1, 0), std::pair(0, -1), std::pair(0, 1)}) {
    if (!in_.depth_m.contains(spot.u + du, spot.v + dv)) continue;
    const Spot neighbour = look(spot.u + du, spot.v + dv);
    if (neighbour.z == 0.F || std::abs(neighbour.z - spot.z) <= widest) continue;
    widest = std::abs(neighbour.z - spot.z);
    other = neighbour;
  }
  return other;
}

/// Returns the reading of a pixel through which a silhouette runs: the light of both sides adds up. Returns no surface
/// if the driver removes the reading.
Aim::Spot Aim::mixed(const Spot& spot) {
  const Spot other = across_silhouette(spot);
  // The silhouette is anywhere within one pixel, and the mixture extends half its width to this side.
  const auto offset = float(random_.uniform());
  if (other.z == 0.F || offset >= 0.5F * sensor_.mixed_px) return spot;
  if (random_.uniform() < sensor_.mixed_loss) return {};
  const float share = 0.5F - offset / sensor_.mixed_px;
  const float mine = (1.F - share) * amplitude(spot) / (spot.z * spot.z);
  const float theirs = share * amplitude(other) / (other.z * other.z);
  Spot both = spot;
  if (mine + theirs > kSmallestLight) both.z = (mine * spot.z + theirs * other.z) / (mine + theirs);
  return both;
}

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
