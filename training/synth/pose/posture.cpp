#include "synth/pose/posture.h"

#include <algorithm>

#include "synth/pose/stick_figure.h"

namespace vesalius::synth {
namespace {

/// Approximate share of the body's mass at the middle of each bone; Winter, table 4.1: trunk with head 0.578, arms 0.05
/// each, thighs 0.1, shins with feet 0.061 each.
constexpr std::array<float, kBoneCount> kMass = {0.142F,  0.139F,  0.216F, 0.02F,   0.061F, 0.F,    0.028F,
                                                 0.016F,  0.006F,  0.F,    0.028F,  0.016F, 0.006F, 0.1F,
                                                 0.0465F, 0.0145F, 0.1F,   0.0465F, 0.0145F};

Eigen::Vector3f centre_of_mass(const StickFigure& figure) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  float mass = 0.F;
  for (std::size_t b = 0; b < kBoneCount; ++b) {
    sum += kMass[b] * 0.5F * (figure.head[b] + figure.tail[b]);
    mass += kMass[b];
  }
  return sum / mass;
}

float lowest_y(const StickFigure& figure) {
  float lowest = figure.head[0].y();
  for (std::size_t b = 0; b < kBoneCount; ++b) lowest = std::min({lowest, figure.head[b].y(), figure.tail[b].y()});
  return lowest;
}

/// Returns the horizontal distance of the centre of mass from the line between the middles of the feet.
float out_of_balance_m(const StickFigure& figure) {
  const auto middle = [&](Bone foot) {
    const Eigen::Vector3f m = 0.5F * (figure.head_of(foot) + figure.tail_of(foot));
    return Eigen::Vector2f(m.x(), m.z());
  };
  const Eigen::Vector3f weight = centre_of_mass(figure);
  const Eigen::Vector2f p(weight.x(), weight.z()), a = middle(Bone::l_foot), b = middle(Bone::r_foot);
  const float along = (p - a).dot(b - a) / std::max((b - a).squaredNorm(), 1e-6F);
  return (p - (a + std::clamp(along, 0.F, 1.F) * (b - a))).norm();
}

/// Returns whether a knee carries weight. It does if no point is lower and it is not higher than its ankle by more than
/// a foot's height.
bool kneels(const StickFigure& figure, Bone shin, float floor_y) {
  const float knee = figure.head_of(shin).y();
  return knee < floor_y + 0.10F && knee < figure.tail_of(shin).y() + 0.08F;
}

}  // namespace

Posture classify_posture(const Pose& pose) {
  const StickFigure figure = stick_figure(pose);
  const auto world = world_rotations(pose);
  const float floor_y = lowest_y(figure);
  const float seat_m = figure.head[0].y() - floor_y;
  const auto slope = [&](Bone bone) { return (world[index(bone)] * rest_direction(bone)).y(); };
  const bool trunk_level = slope(Bone::pelvis) < 0.6F && slope(Bone::chest) < 0.6F;
  if (trunk_level && seat_m < 0.35F) return Posture::lying;
  if (seat_m > 0.15F && (kneels(figure, Bone::l_shin, floor_y) || kneels(figure, Bone::r_shin, floor_y))) {
    return Posture::kneeling;
  }
  const bool thighs_level = slope(Bone::l_thigh) > -0.6F && slope(Bone::r_thigh) > -0.6F;
  const bool on_floor = seat_m < 0.2F;
  if (thighs_level && (on_floor || out_of_balance_m(figure) > 0.2F)) return Posture::sitting;
  return Posture::standing;
}

}  // namespace vesalius::synth
