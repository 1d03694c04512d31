#include "synth/pose/judge_pose.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "synth/pose/body_shapes.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

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

/// Returns whether two regions meet in a joint or fold onto each other, so that contact between them is normal.
bool neighbours(BodyRegion a, BodyRegion b) {
  if (a > b) std::swap(a, b);
  if (a == b) return true;
  const auto is = [&](BodyRegion x, BodyRegion y) { return a == x && b == y; };
  const bool trunk = b <= BodyRegion::head;
  const bool arm =
      is(BodyRegion::l_upper_arm, BodyRegion::l_lower_arm) || is(BodyRegion::r_upper_arm, BodyRegion::r_lower_arm);
  const bool leg = is(BodyRegion::l_thigh, BodyRegion::l_lower_leg) || is(BodyRegion::r_thigh, BodyRegion::r_lower_leg);
  const bool shoulder = a == BodyRegion::chest && (b == BodyRegion::l_upper_arm || b == BodyRegion::r_upper_arm);
  const bool hip = a == BodyRegion::hips && (b == BodyRegion::l_thigh || b == BodyRegion::r_thigh);
  return trunk || arm || leg || shoulder || hip;
}

bool is_lower_arm(BodyRegion r) { return r == BodyRegion::l_lower_arm || r == BodyRegion::r_lower_arm; }
bool is_upper_arm(BodyRegion r) { return r == BodyRegion::l_upper_arm || r == BodyRegion::r_upper_arm; }
bool is_thigh(BodyRegion r) { return r == BodyRegion::l_thigh || r == BodyRegion::r_thigh; }
bool is_trunk(BodyRegion r) { return r <= BodyRegion::chest; }

/// Returns whether people press two regions together: arms against trunk, thighs and each other, hands against the head
/// as well, thighs against each other and the trunk.
bool pressed(BodyRegion a, BodyRegion b) {
  if (a > b) std::swap(a, b);
  if (a == BodyRegion::head) return is_lower_arm(b);
  const bool soft = is_trunk(a) || is_upper_arm(a) || is_lower_arm(a) || is_thigh(a);
  return soft && (is_upper_arm(b) || is_lower_arm(b) || is_thigh(b));
}

/// Two shapes that are compared.
struct Pair {
  std::size_t i, j;
  bool pressed;
};

const std::vector<Pair>& compared_pairs() {
  static const std::vector<Pair> pairs = [] {
    std::vector<Pair> out;
    const auto shapes = body_shapes({});
    for (std::size_t i = 0; i < kBodyShapes; ++i) {
      for (std::size_t j = i + 1; j < kBodyShapes; ++j) {
        const BodyRegion a = shapes[i].region, b = shapes[j].region;
        if (!neighbours(a, b)) out.push_back({i, j, pressed(a, b)});
      }
    }
    return out;
  }();
  return pairs;
}

/// Returns the distance between two segments (Ericson, "Real-Time Collision Detection", section 5.1.9).
float distance(const BodyShape& first, const BodyShape& second) {
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

float overlap_m(const BodyShape& a, const BodyShape& b) { return a.radius_m + b.radius_m - distance(a, b); }

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
  const auto shapes = body_shapes(pose);
  float deepest = std::numeric_limits<float>::lowest();
  for (const Pair& pair : compared_pairs()) deepest = std::max(deepest, overlap_m(shapes[pair.i], shapes[pair.j]));
  return deepest;
}

bool intersects_itself(const Pose& pose, float touch_m) {
  const auto shapes = body_shapes(pose);
  return std::ranges::any_of(compared_pairs(), [&](const Pair& pair) {
    return overlap_m(shapes[pair.i], shapes[pair.j]) > (pair.pressed ? touch_m : kTouch_m);
  });
}

}  // namespace vesalius::synth
