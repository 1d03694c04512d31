#include "synth/clip/stroll.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "synth/mesh/palette.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kStep_s = 1.F / kTrackRate_hz;
constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kDegree = kPi / 180.F;
constexpr float kTurn = 2.F * kPi;

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

constexpr int kLookEvery = 6;  ///< states between two looks at what is in the way: a tenth of a second
constexpr float kPelvis_m = 0.95F;

/// Returns the column of the picture in which a person stands, or nothing outside of it.
std::optional<float> column_of(const View& view, const Vector2f& at) {
  const Vector3f p = view.camera_from_world * Vector3f(at.x(), kPelvis_m, at.y());
  if (p.z() < 0.3F) return std::nullopt;
  const Vector2f pixel = view.camera.pixel(p);
  const bool inside = pixel.x() > 0.F && pixel.x() < float(view.camera.width);
  return inside ? std::optional(pixel.x()) : std::nullopt;
}

/// Tells of places of two people over time whether they have passed before each other.
class CrossingWatch {
 public:
  bool look(const View& view, const Vector2f& a, const Vector2f& b) {
    const auto column = column_of(view, a), other = column_of(view, b);
    const float side = column && other ? *column - *other : 0.F;
    const bool crossed = side * before_ < 0.F;
    before_ = side;
    return crossed;
  }

 private:
  float before_ = 0.F;
};

class Planner {
 public:
  Planner(const ClipOptions& options, const CameraPlacement& placement, const StrollGround& ground,
          const Repertoire& can, const StrollWish& wish, float seconds, Random& random)
      : options_(options),
        placement_(placement),
        ground_(ground),
        can_(can),
        wish_(wish),
        length_(static_cast<std::size_t>(track_length(seconds))),
        random_(random) {
    const Camera& camera = ground.view.camera;
    half_fan_ = std::atan(0.5F * float(camera.width) / camera.fx);
    eye_ = ground.view.camera_from_world.inverse().translation();
    const Vector3f axis = ground.view.camera_from_world.linear().transpose() * Vector3f::UnitZ();
    looks_down_ = axis.y() < -0.8F;
  }

  std::optional<PersonTrack> run() {
    constexpr int kStarts = 12;
    std::optional<PersonTrack> second_best;
    for (int i = 0; i < kStarts; ++i) {
      if (!try_way()) continue;
      if (crossed_ || !wish_.crosses || ground_.people.empty()) return track();
      if (!second_best) second_best = track();
    }
    return second_best;
  }

 private:
  /// What comes next: a goal to walk to, or a stay of so many states.
  struct Deed {
    std::optional<Vector2f> goal;
    int states = 0;
  };

  float draw_side() {
    side_ = chance(0.75, random_) ? -side_ : side_;
    return side_;
  }

  /// Draws a place at the camera's usual distances, most often on the other side than the one before.
  Vector2f draw_place(bool outside) {
    const float rise = eye_.y() - kPelvis_m, far = sample_distance(placement_, random_);
    const float along = std::max(least_m(), std::sqrt(std::max(0.F, far * far - rise * rise)));
    if (looks_down_) {
      const float about = between(-kPi, kPi, random_);
      return along * (outside ? 2.F : 1.F) * front_of(about);
    }
    const float share = outside ? between(1.2, 1.7, random_) : between(0.1, 0.85, random_);
    const float bearing = draw_side() * share * half_fan_;
    return {along * std::sin(bearing), -along * std::cos(bearing)};
  }

  /// Returns the least distance from the camera: a high one may be passed below.
  float least_m() const {
    constexpr float kOverhead_m = 2.3F, kClear_m = 0.65F;
    return eye_.y() > kOverhead_m ? 0.F : kClear_m + ground_.camera_reach_m;
  }

  bool try_way() {
    states_.clear();
    crossed_ = false;
    watches_.assign(ground_.people.size(), {});
    side_ = chance(0.5, random_) ? 1.F : -1.F;
    StrollState start;
    start.at = draw_place(false);
    start.heading_rad = std::atan2(-start.at.x(), -start.at.y()) + between(-kPi, kPi, random_);
    start.stay_s = 0.F;
    if (!is_free(start.at, 0)) return false;
    if (wish_.walks && chance(0.8, random_)) start.go = 1.F, start.staying = 0.F;
    if (wish_.walks && start.go > 0.F) {
      const Vector2f to = draw_place(false) - start.at;
      start.heading_rad = std::atan2(to.x(), to.y());
    }
    states_.push_back(start);
    while (states_.size() < length_) {
      if (!extend()) return false;
    }
    return true;
  }

  Deed draw_deed() {
    const bool paused = states_.back().go == 0.F;
    const bool stays = !wish_.walks || (!paused && chance(options_.pause_share, random_));
    if (!stays) return {draw_place(chance(options_.leaving_share, random_)), 0};
    return {std::nullopt, wish_.walks ? int(between(1.5, 4.5, random_) * kTrackRate_hz) : int(length_)};
  }

  /// Adds the next deed for which there is room, with a crossing if that is still wanted.
  bool extend() {
    constexpr int kTries = 24, kTriesToCross = 10;
    std::vector<StrollState> fallback;
    std::vector<CrossingWatch> fallback_watches;
    for (int i = 0; i < kTries; ++i) {
      std::vector<CrossingWatch> watches = watches_;
      bool crosses = false;
      std::vector<StrollState> part = states_of(draw_deed(), watches, crosses);
      if (part.empty()) continue;
      const bool wanted = wish_.crosses && !crossed_ && !ground_.people.empty();
      if (crosses || !wanted) {
        crossed_ = crossed_ || crosses;
        return take(part, watches);
      }
      if (fallback.empty()) {
        fallback = std::move(part);
        fallback_watches = std::move(watches);
      }
      if (i >= kTriesToCross) break;
    }
    return !fallback.empty() && take(fallback, fallback_watches);
  }

  bool take(const std::vector<StrollState>& part, const std::vector<CrossingWatch>& watches) {
    states_.insert(states_.end(), part.begin(), part.end());
    watches_ = watches;
    return true;
  }

  /// Returns the states of a deed up to its end or that of the clip; none if something is in the way.
  std::vector<StrollState> states_of(const Deed& deed, std::vector<CrossingWatch>& watches, bool& crosses) {
    constexpr float kThere_m = 0.35F;
    constexpr int kLongest = int(12.F * kTrackRate_hz);
    std::vector<StrollState> part;
    StrollState state = states_.back();
    for (int i = 0; states_.size() + part.size() < length_ && i < kLongest; ++i) {
      if (deed.goal ? (*deed.goal - state.at).norm() < kThere_m : i >= deed.states) break;
      advance(can_, deed.goal, state);
      part.push_back(state);
      const std::size_t now = states_.size() + part.size() - 1;
      if (now % kLookEvery != 0 && now + 1 != length_) continue;
      if (!is_free(state.at, now)) return {};
      for (std::size_t p = 0; p < watches.size(); ++p) {
        if (watches[p].look(ground_.view, state.at, ground_.people[p].states[now].at)) crosses = true;
      }
    }
    return part;
  }

  bool is_free(const Vector2f& at, std::size_t now) const {
    constexpr float kPeopleApart_m = 0.75F, kFromBones_m = 0.45F;
    if ((at - Vector2f(eye_.x(), eye_.z())).norm() < least_m()) return false;
    for (const PersonTrack& other : ground_.people) {
      if ((other.states[now].at - at).norm() < kPeopleApart_m) return false;
    }
    for (const auto& bones : ground_.footprints) {
      if (std::ranges::any_of(bones, [&](const Vector2f& p) { return (p - at).norm() < kFromBones_m; })) return false;
    }
    return std::ranges::none_of(ground_.solids, [&](const OrientedBox& box) { return stands_in(box, at); });
  }

  static bool stands_in(const OrientedBox& box, const Vector2f& at) {
    constexpr float kApart_m = 0.35F;
    OrientedBox wide = box;
    wide.half.array() += kApart_m;
    return std::ranges::any_of(std::array{0.1F, 0.5F, 0.9F, 1.3F, 1.7F},
                               [&](float y) { return depth_inside(wide, Vector3f(at.x(), y, at.y())) > 0.F; });
  }

  PersonTrack track() const {
    PersonTrack track;
    track.states.reserve(states_.size());
    for (const StrollState& state : states_) track.states.push_back(shown(can_, state));
    plant_feet(can_.leg_m, track);
    return track;
  }

  const ClipOptions& options_;
  const CameraPlacement& placement_;
  const StrollGround& ground_;
  const Repertoire& can_;
  StrollWish wish_;
  std::size_t length_;
  Random& random_;
  float half_fan_ = 0.F;
  Vector3f eye_;
  bool looks_down_ = false;
  float side_ = 1.F;
  bool crossed_ = false;
  std::vector<CrossingWatch> watches_;
  std::vector<StrollState> states_;
};

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

std::optional<PersonTrack> plan_stroll(const ClipOptions& options, const CameraPlacement& placement,
                                       const StrollGround& ground, const Repertoire& can, const StrollWish& wish,
                                       float seconds, Random& random) {
  return Planner(options, placement, ground, can, wish, seconds, random).run();
}

}  // namespace vesalius::synth
