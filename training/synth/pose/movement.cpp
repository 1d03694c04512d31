#include "synth/pose/movement.h"

#include <algorithm>
#include <cmath>

namespace vesalius::synth {
namespace {

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

Eigen::Vector2f root_at(const Movement& movement, float time_s) {
  const auto [a, b, share] = neighbours(movement, time_s);
  return a->root + share * (b->root - a->root);
}

float heading_at(const Movement& movement, float time_s) {
  const auto [a, b, share] = neighbours(movement, time_s);
  return a->heading_rad + share * (b->heading_rad - a->heading_rad);
}

Movement mirrored(Movement movement) {
  for (BodyState& state : movement.states) {
    state.pose = mirrored(state.pose);
    state.heading_rad = -state.heading_rad;
    state.root.x() = -state.root.x();
  }
  return movement;
}

}  // namespace vesalius::synth
