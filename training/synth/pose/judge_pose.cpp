#include "synth/pose/judge_pose.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

/// Approximate share of the body's mass at the middle of each bone; Winter, table 4.1: trunk with head 0.578, arms 0.05
/// each, thighs 0.1, shins with feet 0.061 each.
constexpr std::array<float, kBoneCount> kMass = {0.142F,  0.139F,  0.216F, 0.02F,   0.061F, 0.F,    0.028F,
                                                 0.016F,  0.006F,  0.F,    0.028F,  0.016F, 0.006F, 0.1F,
                                                 0.0465F, 0.0145F, 0.1F,   0.0465F, 0.0145F};

Vector3f centre_of_mass(const StickFigure& figure) {
  Vector3f sum = Vector3f::Zero();
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
    const Vector3f m = 0.5F * (figure.head_of(foot) + figure.tail_of(foot));
    return Eigen::Vector2f(m.x(), m.z());
  };
  const Vector3f weight = centre_of_mass(figure);
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

/// The region of a capsule. Capsules of one region are never compared, nor are those of neighbouring regions.
enum class Region : std::uint8_t {
  hips,
  waist,
  chest,
  head,
  l_upper_arm,
  l_lower_arm,
  r_upper_arm,
  r_lower_arm,
  l_thigh,
  l_lower_leg,
  r_thigh,
  r_lower_leg
};

/// A rounded piece of the body from one point of a bone to another, in the bone's rest frame, metres.
struct Shape {
  Region region;
  Bone bone;
  std::array<float, 3> from, to;
  float radius;
};

// These are the sizes of a slim adult 1.72 m tall, measured along the bones' rest directions. The trunk consists of
// capsules that lie across, since it is wider than deep. Thighs and upper arms begin below the joint, where they leave
// the trunk.
constexpr std::array<Shape, 25> kShapes{{
    {Region::hips, Bone::pelvis, {-0.07F, 0.02F, -0.02F}, {0.07F, 0.02F, -0.02F}, 0.105F},
    {Region::waist, Bone::spine, {-0.05F, 0.06F, 0.F}, {0.05F, 0.06F, 0.F}, 0.095F},
    {Region::chest, Bone::chest, {-0.06F, 0.03F, 0.F}, {0.06F, 0.03F, 0.F}, 0.10F},
    {Region::chest, Bone::chest, {-0.08F, 0.12F, 0.F}, {0.08F, 0.12F, 0.F}, 0.095F},
    {Region::head, Bone::neck, {0.F, 0.04F, 0.F}, {0.F, 0.08F, 0.F}, 0.05F},
    {Region::head, Bone::head, {0.F, 0.06F, 0.015F}, {0.F, 0.13F, 0.01F}, 0.085F},
    {Region::l_upper_arm, Bone::l_upper_arm, {0.12F, 0.F, 0.F}, {0.31F, 0.F, 0.F}, 0.042F},
    {Region::l_lower_arm, Bone::l_forearm, {0.03F, 0.F, 0.F}, {0.24F, 0.F, 0.F}, 0.035F},
    {Region::l_lower_arm, Bone::l_hand, {0.02F, 0.F, 0.02F}, {0.10F, 0.F, 0.02F}, 0.02F},
    {Region::l_lower_arm, Bone::l_hand, {0.02F, 0.F, -0.02F}, {0.10F, 0.F, -0.02F}, 0.02F},
    {Region::r_upper_arm, Bone::r_upper_arm, {-0.12F, 0.F, 0.F}, {-0.31F, 0.F, 0.F}, 0.042F},
    {Region::r_lower_arm, Bone::r_forearm, {-0.03F, 0.F, 0.F}, {-0.24F, 0.F, 0.F}, 0.035F},
    {Region::r_lower_arm, Bone::r_hand, {-0.02F, 0.F, 0.02F}, {-0.10F, 0.F, 0.02F}, 0.02F},
    {Region::r_lower_arm, Bone::r_hand, {-0.02F, 0.F, -0.02F}, {-0.10F, 0.F, -0.02F}, 0.02F},
    {Region::l_thigh, Bone::l_thigh, {0.F, -0.16F, 0.F}, {0.F, -0.28F, 0.F}, 0.07F},
    {Region::l_thigh, Bone::l_thigh, {0.F, -0.28F, 0.F}, {0.F, -0.42F, 0.F}, 0.055F},
    {Region::l_lower_leg, Bone::l_shin, {0.F, -0.04F, 0.F}, {0.F, -0.25F, -0.01F}, 0.05F},
    {Region::l_lower_leg, Bone::l_shin, {0.F, -0.25F, 0.F}, {0.F, -0.42F, 0.F}, 0.04F},
    {Region::l_lower_leg, Bone::l_foot, {0.F, -0.03F, -0.03F}, {0.F, -0.04F, 0.17F}, 0.035F},
    {Region::r_thigh, Bone::r_thigh, {0.F, -0.16F, 0.F}, {0.F, -0.28F, 0.F}, 0.07F},
    {Region::r_thigh, Bone::r_thigh, {0.F, -0.28F, 0.F}, {0.F, -0.42F, 0.F}, 0.055F},
    {Region::r_lower_leg, Bone::r_shin, {0.F, -0.04F, 0.F}, {0.F, -0.25F, -0.01F}, 0.05F},
    {Region::r_lower_leg, Bone::r_shin, {0.F, -0.25F, 0.F}, {0.F, -0.42F, 0.F}, 0.04F},
    {Region::r_lower_leg, Bone::r_foot, {0.F, -0.03F, -0.03F}, {0.F, -0.04F, 0.17F}, 0.035F},
    {Region::head, Bone::head, {0.F, 0.02F, 0.05F}, {0.F, 0.06F, 0.06F}, 0.05F},
}};

/// Returns whether two regions meet in a joint or fold onto each other, so that contact between them is normal.
bool neighbours(Region a, Region b) {
  if (a > b) std::swap(a, b);
  if (a == b) return true;
  const auto is = [&](Region x, Region y) { return a == x && b == y; };
  const bool trunk = b <= Region::head;
  const bool arm = is(Region::l_upper_arm, Region::l_lower_arm) || is(Region::r_upper_arm, Region::r_lower_arm);
  const bool leg = is(Region::l_thigh, Region::l_lower_leg) || is(Region::r_thigh, Region::r_lower_leg);
  const bool shoulder = a == Region::chest && (b == Region::l_upper_arm || b == Region::r_upper_arm);
  const bool hip = a == Region::hips && (b == Region::l_thigh || b == Region::r_thigh);
  return trunk || arm || leg || shoulder || hip;
}

using Pair = std::pair<std::size_t, std::size_t>;

const std::vector<Pair>& compared_pairs() {
  static const std::vector<Pair> pairs = [] {
    std::vector<Pair> out;
    for (std::size_t i = 0; i < kShapes.size(); ++i) {
      for (std::size_t j = i + 1; j < kShapes.size(); ++j) {
        if (!neighbours(kShapes[i].region, kShapes[j].region)) out.emplace_back(i, j);
      }
    }
    return out;
  }();
  return pairs;
}

struct Segment {
  Vector3f from;
  Vector3f to;
};

/// Returns the distance between two segments (Ericson, "Real-Time Collision Detection", section 5.1.9).
float distance(const Segment& first, const Segment& second) {
  const Vector3f d1 = first.to - first.from, d2 = second.to - second.from, r = first.from - second.from;
  const float a = d1.squaredNorm(), e = d2.squaredNorm(), f = d2.dot(r), c = d1.dot(r), b = d1.dot(d2);
  const float denominator = a * e - b * b;
  float s = denominator > 1e-12F ? std::clamp((b * f - c * e) / denominator, 0.F, 1.F) : 0.F;
  float t = (b * s + f) / e;
  if (t < 0.F || t > 1.F) {
    t = std::clamp(t, 0.F, 1.F);
    s = std::clamp((b * t - c) / a, 0.F, 1.F);
  }
  return (first.from + d1 * s - second.from - d2 * t).norm();
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

float self_overlap_m(const Pose& pose) {
  const StickFigure figure = stick_figure(pose);
  const auto world = world_rotations(pose);
  std::array<Segment, kShapes.size()> segments;
  for (std::size_t i = 0; i < kShapes.size(); ++i) {
    const auto bone = static_cast<std::size_t>(kShapes[i].bone);
    const auto place = [&](const std::array<float, 3>& p) {
      return (figure.head[bone] + world[bone] * Vector3f(p[0], p[1], p[2])).eval();
    };
    segments[i] = {place(kShapes[i].from), place(kShapes[i].to)};
  }
  float deepest = std::numeric_limits<float>::lowest();
  for (const auto& [i, j] : compared_pairs()) {
    deepest = std::max(deepest, kShapes[i].radius + kShapes[j].radius - distance(segments[i], segments[j]));
  }
  return deepest;
}

bool intersects_itself(const Pose& pose) {
  // Flesh yields and bodies differ: hands on hips, crossed arms and legs touch.
  constexpr float kTouch_m = 0.03F;
  return self_overlap_m(pose) > kTouch_m;
}

}  // namespace vesalius::synth
