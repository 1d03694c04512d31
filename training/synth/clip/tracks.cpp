#include "synth/clip/tracks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "synth/mesh/palette.h"
#include "synth/scene/person_plan.h"

namespace vesalius::synth {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;

constexpr float kStep_s = 1.F / kTrackRate_hz;
constexpr float kTurn = 2.F * std::numbers::pi_v<float>;
constexpr float kDegree = kTurn / 360.F;

/// A value that swings smoothly about 0: two sines whose speed never exceeds a limit.
class Swing {
 public:
  /// `low_hz` to `high_hz` are the frequencies; the value stays within `reach`.
  Swing(float reach, float fastest, double low_hz, double high_hz, Random& random) {
    for (Wave& wave : waves_) {
      wave.hz = between(low_hz, high_hz, random);
      wave.phase = between(0.0, kTurn, random);
      wave.size = std::min(0.5F * reach, 0.5F * fastest / (kTurn * wave.hz)) * between(0.6, 1.0, random);
    }
  }

  float at(float time_s) const {
    float sum = 0.F;
    for (const Wave& wave : waves_) sum += wave.size * std::sin(kTurn * wave.hz * time_s + wave.phase);
    return sum;
  }

 private:
  struct Wave {
    float size = 0.F, hz = 1.F, phase = 0.F;
  };
  std::array<Wave, 2> waves_;
};

/// Returns the bearing of the middle of the people as seen from the world's origin, positive to the camera's left.
float bearing_of(const std::vector<PersonTrack>& people, int step) {
  Eigen::Vector2f middle = Eigen::Vector2f::Zero();
  for (const PersonTrack& person : people) middle += person.states[step].at;
  return std::atan2(-middle.x(), -middle.y());
}

/// Follows the middle of the people with limited speed and acceleration.
class Follower {
 public:
  explicit Follower(float fastest) : fastest_(fastest) {}

  float next(float wanted) {
    constexpr float kMost = 25.F * kDegree, kPerSecond = 0.8F, kSettle_s = 0.6F;
    const float off = std::clamp(wanted, -kMost, kMost) - yaw_;
    speed_ += (std::clamp(kPerSecond * off, -fastest_, fastest_) - speed_) * kStep_s / kSettle_s;
    yaw_ += speed_ * kStep_s;
    return yaw_;
  }

 private:
  float fastest_, yaw_ = 0.F, speed_ = 0.F;
};

}  // namespace

TrackState PersonTrack::at(float time_s) const {
  const float place = std::clamp(time_s * kTrackRate_hz, 0.F, float(states.size() - 1));
  const auto first = static_cast<std::size_t>(place);
  const float share = place - float(first);
  const TrackState& a = states[first];
  if (share == 0.F) return a;
  const TrackState& b = states[first + 1];
  return {interpolated(a.pose, b.pose, share), a.at + share * (b.at - a.at),
          a.heading_rad + share * (b.heading_rad - a.heading_rad), a.seated + share * (b.seated - a.seated)};
}

int track_length(float seconds) { return int(std::ceil(seconds * kTrackRate_hz)) + 1; }

PosedBody body_at(const Poser& poser, const PersonTrack& track, float time_s) {
  const TrackState state = track.at(time_s);
  PosedBody body = poser.pose(state.pose);
  const float lift = track.pelvis_m ? state.seated * (*track.pelvis_m - body.joints[index(Bone::pelvis)].y()) : 0.F;
  const Eigen::Isometry3f world_from_body(Eigen::Translation3f(state.at.x(), lift, state.at.y()) *
                                          Eigen::AngleAxisf(state.heading_rad, Eigen::Vector3f::UnitY()));
  return moved(std::move(body), world_from_body);
}

Eigen::Vector2f front_of(float heading_rad) { return {std::sin(heading_rad), std::cos(heading_rad)}; }
Eigen::Vector2f left_of(float heading_rad) { return {std::cos(heading_rad), -std::sin(heading_rad)}; }

Isometry3f CameraTrack::at(float time_s) const {
  const float place = std::clamp(time_s * kTrackRate_hz, 0.F, float(poses.size() - 1));
  const auto first = static_cast<std::size_t>(place);
  const float share = place - float(first);
  const Isometry3f& a = poses[first];
  if (share == 0.F) return a;
  const Isometry3f& b = poses[first + 1];
  Isometry3f pose = Isometry3f::Identity();
  pose.linear() =
      Eigen::Quaternionf(a.linear()).slerp(share, Eigen::Quaternionf(b.linear())).normalized().toRotationMatrix();
  pose.translation() = a.translation() + share * (b.translation() - a.translation());
  return pose;
}

CameraTrack move_camera(const ClipOptions& options, const CameraPose& base, float seconds,
                        const std::vector<PersonTrack>& people, Random& random) {
  const bool in_hand = chance(0.5, random);
  const float speed = options.speed_max_m_s * between(0.4, 1.0, random);
  const float turn = options.turn_max_deg_s * kDegree;
  // The three axes together stay below the greatest speed: 0.7^2 + 0.7^2 + 0.14^2 is 1.
  const Swing x(0.7F * kCameraReach_m, 0.7F * speed, 0.04, 0.2, random);
  const Swing z(0.7F * kCameraReach_m, 0.7F * speed, 0.04, 0.2, random);
  const Swing y(in_hand ? 0.06F : 0.F, 0.14F * speed, 0.1, 0.5, random);
  const Swing shake_yaw(in_hand ? 0.4F * kDegree : 0.F, 0.15F * turn, 0.8, 3.0, random);
  const Swing shake_pitch(in_hand ? 0.6F * kDegree : 0.F, 0.15F * turn, 0.8, 3.0, random);
  const Swing sway_pitch(in_hand ? 4.F * kDegree : 0.5F * kDegree, 0.1F * turn, 0.1, 0.4, random);
  const Swing sway_roll(in_hand ? 3.F * kDegree : 0.3F * kDegree, 0.1F * turn, 0.1, 0.6, random);
  const Swing wander(6.F * kDegree, 0.1F * turn, 0.05, 0.2, random);
  Follower follower(0.55F * turn);
  CameraTrack track;
  for (int i = 0; i < track_length(seconds); ++i) {
    const float t = float(i) * kStep_s;
    const float yaw = follower.next(people.empty() ? 0.F : bearing_of(people, i)) + wander.at(t) + shake_yaw.at(t);
    CameraPose now = base;
    now.height_m += y.at(t) - y.at(0.F);
    now.pitch_rad += shake_pitch.at(t) + sway_pitch.at(t);
    now.roll_rad += sway_roll.at(t);
    const Vector3f at(x.at(t), 0.F, z.at(t));
    track.poses.push_back(Eigen::Translation3f(at) * Eigen::AngleAxisf(yaw, Vector3f::UnitY()) *
                          now.world_from_camera());
  }
  return track;
}

}  // namespace vesalius::synth
