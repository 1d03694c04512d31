#include "synth/sensor/noise_aim.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "synth/sensor/noise_kernel.h"
#include "synth/sensor/noise_occlusion.h"

namespace vesalius::synth {
namespace {

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

}  // namespace

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
  for (Eigen::ArrayXf* padded : {&row_.z, &row_.cosine, &row_.infrared, &row_.fall_off}) {
    *padded = Eigen::ArrayXf::Zero(padded_width(width_));
  }
  row_.source.resize(width_);
}

const AimedRow& Aim::row(int v, const Eigen::ArrayXf& losses) {
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
  const float furthest_px = float(std::abs(du) + std::abs(dv));
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

}  // namespace vesalius::synth
