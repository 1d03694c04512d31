#include "synth/clip/plant_feet.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "synth/pose/stick_figure.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr std::size_t kPoints = 4;  ///< ankle and toes of both feet

/// The points of the feet in the world, and how much weight may rest on them.
struct Feet {
  std::array<Vector2f, kPoints> at;
  std::array<float, kPoints> weight;
};

Feet feet_of(const TrackState& state, float scale) {
  constexpr float kAnkle_m = 0.07F, kSoft_m = 0.02F;
  const StickFigure figure = stick_figure(state.pose);
  const Eigen::AngleAxisf turn(state.heading_rad, Vector3f::UnitY());
  const std::array points = {figure.head_of(Bone::l_foot), figure.tail_of(Bone::l_foot), figure.head_of(Bone::r_foot),
                             figure.tail_of(Bone::r_foot)};
  std::array<float, kPoints> height{};
  for (std::size_t i = 0; i < kPoints; ++i) height[i] = scale * points[i].y() - (i % 2 == 0 ? kAnkle_m : 0.F);
  const float lowest = *std::min_element(height.begin(), height.end());
  Feet feet;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const Vector3f p = turn * (scale * points[i]);
    feet.at[i] = state.at + Vector2f(p.x(), p.z());
    feet.weight[i] = std::exp(-(height[i] - lowest) / kSoft_m);
  }
  return feet;
}

/// Returns how far the feet on the floor slide from one state to the next.
Vector2f slip(const Feet& a, const Feet& b) {
  Vector2f sum = Vector2f::Zero();
  float weights = 0.F;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const float weight = a.weight[i] * b.weight[i];
    sum += weight * (b.at[i] - a.at[i]);
    weights += weight;
  }
  return sum / weights;
}

}  // namespace

void plant_feet(float leg_m, PersonTrack& track) {
  constexpr float kReturn_s = 0.8F, kFarthest_m = 0.15F;
  const float scale = leg_m / (bone_length_m(Bone::l_thigh) + bone_length_m(Bone::l_shin));
  const float kept = std::exp(-1.F / (kReturn_s * kTrackRate_hz));
  Vector2f off = Vector2f::Zero();
  Feet before = feet_of(track.states.front(), scale);
  for (TrackState& state : track.states) {
    const Feet now = feet_of(state, scale);
    off = kept * off - slip(before, now);
    before = now;
    const float far = off.norm() / kFarthest_m;
    state.at += off / std::sqrt(1.F + far * far);
  }
}

}  // namespace vesalius::synth
