#include "synth/clip/stroll.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vesalius::synth {
namespace {

using Eigen::Vector2f;

constexpr float kStep_s = 1.F / kTrackRate_hz;
constexpr float kDegree = std::numbers::pi_v<float> / 180.F;
constexpr float kTurn = 2.F * std::numbers::pi_v<float>;

float smooth(float share) { return share * share * (3.F - 2.F * share); }

float approached(float value, float goal, float most) { return value + std::clamp(goal - value, -most, most); }

/// Returns by how much a stay has turned the person so far.
float turned_by(const Movement& stay, float time_s) {
  return heading_at(stay, time_s) - stay.states.front().heading_rad;
}

void turn(const std::optional<Vector2f>& goal, StrollState& state) {
  constexpr float kFastest = 85.F * kDegree, kQuickest = 280.F * kDegree, kPerSecond = 2.5F;
  float wanted = 0.F;
  if (goal) {
    const Vector2f way = *goal - state.at;
    const float off = std::remainder(std::atan2(way.x(), way.y()) - state.heading_rad, kTurn);
    wanted = std::clamp(kPerSecond * off, -kFastest, kFastest);
  }
  state.turn_rad_s = approached(state.turn_rad_s, wanted, kQuickest * kStep_s);
  state.heading_rad += state.turn_rad_s * kStep_s;
}

void walk(const Repertoire& can, StrollState& state) {
  const float later = state.gait_s + smooth(state.go) * kStep_s;
  const float ahead = root_at(can.gait, later).y() - root_at(can.gait, state.gait_s).y();
  state.at += can.leg_m * ahead * front_of(state.heading_rad);
  state.gait_s = later;
}

/// Begins a stay. The pose goes over into it, and the heading goes on from where the stay before ended.
void begin_stay(const Repertoire& can, std::size_t next, StrollState& state) {
  state.held = state.stay;
  state.held_s = state.stay_s;
  state.fade = state.staying > 0.F ? 0.F : 1.F;
  if (state.staying > 0.F) state.heading_rad += smooth(state.staying) * turned_by(can.stays[state.stay], state.stay_s);
  state.stay = next;
  state.stay_s = 0.F;
}

void stay(const Repertoire& can, StrollState& state) {
  constexpr float kFade_s = 0.6F;
  const Movement& now = can.stays[state.stay];
  if (state.stay_s >= now.seconds() && state.fade >= 1.F) {
    return begin_stay(can, (state.stay + 1) % can.stays.size(), state);
  }
  const float later = std::min(state.stay_s + kStep_s, now.seconds());
  const Vector2f way = can.leg_m * (root_at(now, later) - root_at(now, state.stay_s));
  const float about = state.heading_rad - now.states.front().heading_rad;
  state.at += way.x() * left_of(about) + way.y() * front_of(about);
  state.stay_s = later;
  state.fade = std::min(1.F, state.fade + kStep_s / kFade_s);
}

}  // namespace

void advance(const Repertoire& can, const std::optional<Vector2f>& goal, StrollState& state) {
  constexpr float kRunUp_s = 0.7F, kGoOver_s = 0.6F;
  if (!goal && state.staying == 0.F) begin_stay(can, (state.stay + 1) % can.stays.size(), state);
  state.go = approached(state.go, goal ? 1.F : 0.F, kStep_s / kRunUp_s);
  state.staying = approached(state.staying, goal ? 0.F : 1.F, kStep_s / kGoOver_s);
  turn(goal, state);
  if (state.go > 0.F) walk(can, state);
  if (!goal) stay(can, state);
}

TrackState shown(const Repertoire& can, const StrollState& state) {
  TrackState out{Pose(), state.at, state.heading_rad};
  const float share = smooth(state.staying);
  const BodyState walking = state_at(can.gait, state.gait_s);
  if (share > 0.F) {
    out.pose = state_at(can.stays[state.stay], state.stay_s).pose;
    if (state.fade < 1.F) {
      const Pose before = state_at(can.stays[state.held], state.held_s).pose;
      out.pose = interpolated(before, out.pose, smooth(state.fade));
    }
  }
  if (share < 1.F) out.pose = interpolated(walking.pose, out.pose, share);
  out.heading_rad += (1.F - share) * walking.heading_rad;
  if (share > 0.F) out.heading_rad += share * turned_by(can.stays[state.stay], state.stay_s);
  out.at += (1.F - share) * can.leg_m * walking.root.x() * left_of(state.heading_rad);
  return out;
}

}  // namespace vesalius::synth
