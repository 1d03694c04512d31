#include "synth/pose/movement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "synth/pose/pose_kinds.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector2f;

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kDegree = kPi / 180.F;
constexpr float kHeel_m = 0.15F;  ///< twice the height of the ankle over toes that stand

float wrapped(float angle) { return std::remainder(angle, 2.F * kPi); }

/// Two states next to each other in time, and how far a time is from the first to the second.
struct Neighbours {
  const BodyState* a;
  const BodyState* b;
  float share;
};

Neighbours neighbours(const Movement& movement, float time_s) {
  const std::size_t last = movement.states.size() - 1;
  const float place = std::clamp(time_s * movement.fps, 0.F, float(last));
  const std::size_t first = std::min(static_cast<std::size_t>(place), last);
  return {&movement.states[first], &movement.states[std::min(first + 1, last)], place - float(first)};
}

/// A stretch of a movement as one period of a walk.
struct Stretch {
  std::size_t first = 0, last = 0;
  float misfit_rad = 0.F;  ///< largest angle between the poses of both ends
};

/// Tells whether a person goes straight ahead from one state to another at the speed of a walk.
bool walks(const Movement& movement, std::size_t first, std::size_t last) {
  constexpr float kSlowest = 0.35F, kFastest = 2.3F, kMostAside = 25.F * kDegree, kStraight = 0.9F;
  const auto& states = movement.states;
  const Vector2f way = states[last].root - states[first].root;
  const float speed = way.norm() * movement.fps / float(last - first);
  if (speed < kSlowest || speed > kFastest) return false;
  const float ahead = std::atan2(way.x(), way.y());
  float length = 0.F, turned = 0.F;
  for (std::size_t i = first; i < last; ++i) {
    length += (states[i + 1].root - states[i].root).norm();
    turned += wrapped(states[i].heading_rad - ahead);
    if (std::abs(wrapped(states[i].heading_rad - ahead)) > 2.F * kMostAside) return false;
  }
  return way.norm() > kStraight * length && std::abs(turned) < kMostAside * float(last - first);
}

std::optional<Stretch> best_stretch(const Movement& movement) {
  constexpr float kShortest_s = 0.7F, kLongest_s = 2.6F, kMostMisfit = 16.F * kDegree;
  const auto& states = movement.states;
  const auto shortest = static_cast<std::size_t>(std::max(2.F, kShortest_s * movement.fps));
  const auto longest = static_cast<std::size_t>(kLongest_s * movement.fps);
  std::optional<Stretch> best;
  for (std::size_t first = 0; first + shortest < states.size(); ++first) {
    for (std::size_t last = first + shortest; last < std::min(states.size(), first + longest + 1); ++last) {
      const float misfit = largest_angle(states[first].pose, states[last].pose);
      if (misfit > (best ? best->misfit_rad : kMostMisfit) || !walks(movement, first, last)) continue;
      best = Stretch{first, last, misfit};
    }
  }
  return best;
}

/// Returns the pose turned by a share of the turn from `from` to `to` in every joint.
Pose adjusted(const Pose& pose, const Pose& from, const Pose& to, float share) {
  Pose out = pose;
  for (std::size_t b = 0; b < kBoneCount; ++b) {
    const Eigen::Quaternionf turn = from.local[b].conjugate() * to.local[b];
    out.local[b] = (pose.local[b] * Eigen::Quaternionf::Identity().slerp(share, turn)).normalized();
  }
  return out;
}

/// Makes the ends of a stretch alike, and measures along its way.
Gait gait_of(const Movement& movement, const Stretch& stretch) {
  const auto& states = movement.states;
  const BodyState &begin = states[stretch.first], &end = states[stretch.last];
  const Vector2f way = end.root - begin.root, ahead = way.normalized();
  const float direction = std::atan2(way.x(), way.y());
  const float turned = end.heading_rad - begin.heading_rad;
  const auto count = float(stretch.last - stretch.first);
  Gait gait;
  gait.period_s = count / movement.fps;
  gait.stride = way.norm();
  for (std::size_t i = stretch.first; i < stretch.last; ++i) {
    const float share = float(i - stretch.first) / count;
    const Vector2f gone = states[i].root - begin.root;
    gait.states.push_back({adjusted(states[i].pose, end.pose, begin.pose, share),
                           wrapped(states[i].heading_rad - direction) - (share - 0.5F) * turned,
                           {gone.x() * ahead.y() - gone.y() * ahead.x(), gone.dot(ahead)}});
  }
  return gait;
}

/// Returns how far the foot that carries the weight goes back under the hips from one pose to the next: that of the two
/// which goes back more, since the other one swings to the front.
float step_back_m(const StickFigure& a, const StickFigure& b) {
  float back_m = std::numeric_limits<float>::lowest();
  for (const Bone foot : {Bone::l_foot, Bone::r_foot}) {
    const bool on_toes =
        a.tail_of(foot).y() + b.tail_of(foot).y() < a.head_of(foot).y() + b.head_of(foot).y() - kHeel_m;
    const float from = on_toes ? a.tail_of(foot).z() : a.head_of(foot).z();
    const float to = on_toes ? b.tail_of(foot).z() : b.head_of(foot).z();
    back_m = std::max(back_m, from - to);
  }
  return back_m;
}

/// A time in a gait: states next to each other, how far it is between them, and the whole periods before.
struct Place {
  std::size_t first, second;
  float share, whole;
};

Place place_in(const Gait& gait, float time_s) {
  const float periods = time_s / gait.period_s, whole = std::floor(periods);
  const std::size_t count = gait.states.size();
  const float place = (periods - whole) * float(count);
  const std::size_t first = std::min(static_cast<std::size_t>(place), count - 1);
  return {first, (first + 1) % count, place - float(first), whole};
}

void mirror(std::vector<BodyState>& states) {
  for (BodyState& state : states) {
    state.pose = mirrored(state.pose);
    state.heading_rad = -state.heading_rad;
    state.root.x() = -state.root.x();
  }
}

}  // namespace

Pose interpolated(const Pose& a, const Pose& b, float share) {
  Pose out;
  for (std::size_t i = 0; i < kBoneCount; ++i) out.local[i] = a.local[i].slerp(share, b.local[i]).normalized();
  out.l_grip = a.l_grip + share * (b.l_grip - a.l_grip);
  out.r_grip = a.r_grip + share * (b.r_grip - a.r_grip);
  return out;
}

BodyState state_at(const Movement& movement, float time_s) {
  const auto [a, b, share] = neighbours(movement, time_s);
  if (share == 0.F) return *a;
  return {interpolated(a->pose, b->pose, share), a->heading_rad + share * (b->heading_rad - a->heading_rad),
          a->root + share * (b->root - a->root), a->height + share * (b->height - a->height)};
}

Vector2f root_at(const Movement& movement, float time_s) {
  const auto [a, b, share] = neighbours(movement, time_s);
  return a->root + share * (b->root - a->root);
}

float heading_at(const Movement& movement, float time_s) {
  const auto [a, b, share] = neighbours(movement, time_s);
  return a->heading_rad + share * (b->heading_rad - a->heading_rad);
}

Movement mirrored(Movement movement) {
  mirror(movement.states);
  return movement;
}

BodyState state_at(const Gait& gait, float time_s) {
  const auto [first, second, share, whole] = place_in(gait, time_s);
  const BodyState &a = gait.states[first], &b = gait.states[second];
  return {interpolated(a.pose, b.pose, share), a.heading_rad + share * (b.heading_rad - a.heading_rad),
          root_at(gait, time_s)};
}

Vector2f root_at(const Gait& gait, float time_s) {
  const auto [first, second, share, whole] = place_in(gait, time_s);
  const Vector2f from = gait.states[first].root;
  const Vector2f to = gait.states[second].root + Vector2f(0.F, second == 0 ? gait.stride : 0.F);
  return from + share * (to - from) + Vector2f(0.F, whole * gait.stride);
}

Gait mirrored(Gait gait) {
  mirror(gait.states);
  return gait;
}

std::optional<Gait> find_gait(const Movement& movement) {
  const std::optional<Stretch> stretch = best_stretch(movement);
  return stretch ? std::optional(gait_of(movement, *stretch)) : std::nullopt;
}

Gait sample_gait(Random& random) {
  constexpr int kStates = 36;
  const kinds::WalkStyle style = kinds::draw_walk(random);
  Gait gait;
  gait.period_s = 1.12F / std::sqrt(std::max(style.length, 0.5F)) * kinds::between(random, 0.92F, 1.1F);
  for (int i = 0; i < kStates; ++i) {
    gait.states.push_back({kinds::walking_at(style, float(i) / kStates), 0.F, Vector2f::Zero()});
  }
  const float leg_m = bone_length_m(Bone::l_thigh) + bone_length_m(Bone::l_shin);
  for (int i = 0; i < kStates; ++i) {
    gait.states[i].root.y() = gait.stride;
    const StickFigure a = stick_figure(gait.states[i].pose), b = stick_figure(gait.states[(i + 1) % kStates].pose);
    gait.stride += std::max(0.F, step_back_m(a, b)) / leg_m;
  }
  return gait;
}

}  // namespace vesalius::synth
