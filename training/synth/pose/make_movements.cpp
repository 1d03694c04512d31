#include "synth/pose/make_movements.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "synth/pose/joint_angles.h"
#include "synth/pose/judge_pose.h"
#include "synth/pose/pose_sampler.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kFps = 30.F;

float between(float low, float high, Random& random) { return float(random.uniform(low, high)); }

/// Returns where the middle of the ankles is from that of the hips, in lengths of the leg: x and z.
Vector2f ankles_of(const Pose& pose) {
  const StickFigure figure = stick_figure(pose);
  const Vector3f middle = 0.5F * (figure.head_of(Bone::l_foot) + figure.head_of(Bone::r_foot));
  return Vector2f(middle.x(), middle.z()) / (bone_length_m(Bone::l_thigh) + bone_length_m(Bone::l_shin));
}

float smooth(float share) { return share * share * (3.F - 2.F * share); }

/// Returns a pose with the trunk bent forwards by an angle more.
Pose bent_forwards(Pose pose, float by_rad) {
  const Eigen::Quaternionf turn(Eigen::AngleAxisf(0.5F * by_rad, Vector3f::UnitX()));
  for (const Bone bone : {Bone::spine, Bone::chest}) pose[bone] = pose[bone] * turn;
  return pose;
}

constexpr float kMeanSpeed_rad_s = 1.7F;  ///< the fastest moment of a move has half as much more

Pose draw_other(const Pose& base, std::span<const Pose> others, Random& random) {
  if (others.empty()) return base;
  const Pose& other = others[random.below(static_cast<std::uint32_t>(others.size()))];
  const std::uint32_t bits = 1 + random.below(7);
  const Pose mixed = mix_limbs(
      base, other, {.l_arm = (bits & 1U) != 0, .r_arm = (bits & 2U) != 0, .legs = false, .head = (bits & 4U) != 0});
  return intersects_itself(mixed) ? base : mixed;
}

/// Returns whether arms that turn the shorter way pass through the body.
bool passes_through(const Pose& from, const Pose& to) {
  return std::ranges::any_of(std::array{0.25F, 0.5F, 0.75F},
                             [&](float share) { return intersects_itself(interpolated(from, to, share)); });
}

}  // namespace

float eased(float share, bool falling) { return falling ? share * share : smooth(share); }

Movement move_through(std::span<const KeyPose> keys) {
  Movement movement;
  movement.name = "change of posture";
  movement.fps = kFps;
  const float seconds = keys.back().at_s - keys.front().at_s;
  const int last = int(std::ceil(seconds * kFps));
  std::size_t next = 1;
  Vector2f root = Vector2f::Zero();  // at the pose before
  const auto root_on_the_way = [&](const Pose& pose) -> Vector2f {
    if (!keys[next].feet_stay) return root;
    return root + ankles_of(keys[next - 1].pose) - ankles_of(pose);
  };
  for (int i = 0; i <= last; ++i) {
    const float time_s = keys.front().at_s + std::min(seconds, float(i) / kFps);
    while (next + 1 < keys.size() && time_s >= keys[next].at_s) {
      root = root_on_the_way(keys[next].pose);
      ++next;
    }
    const KeyPose &from = keys[next - 1], &to = keys[next];
    const float share = std::clamp((time_s - from.at_s) / (to.at_s - from.at_s), 0.F, 1.F);
    BodyState& state = movement.states.emplace_back();
    state.pose = interpolated(from.pose, to.pose, eased(share, to.falling));
    state.root = root_on_the_way(state.pose);
  }
  return movement;
}

Movement fall_down(const Pose& standing, const Pose& lying, Random& random) {
  // Legs half folded, as of somebody who squats.
  BodyAngles folded;
  for (LegAngles& leg : folded.legs) leg = {.flexion = 60.F, .knee = 80.F, .ankle = 20.F};
  const Pose squat = mix_limbs(standing, pose_of(folded), {.legs = true});
  const float seconds = between(0.7F, 1.2F, random);
  const std::array keys{KeyPose{standing, 0.F},
                        KeyPose{interpolated(squat, lying, between(0.1F, 0.25F, random)), 0.5F * seconds, true},
                        KeyPose{lying, seconds, false}};
  return move_through(keys);
}

Movement sit_down(const Pose& standing, const Pose& sitting, Random& random) {
  const float seconds = between(1.F, 2.F, random);
  // Feet a little before the knees, so that who rises stands clear of the seat.
  BodyAngles on_edge;
  for (LegAngles& leg : on_edge.legs) leg = {.flexion = 88.F, .abduction = 6.F, .knee = 72.F};
  const Pose perched = mix_limbs(sitting, pose_of(on_edge), {.legs = true});
  const Pose half = bent_forwards(interpolated(standing, perched, 0.5F), between(0.3F, 0.6F, random));
  return move_through(std::array{KeyPose{standing, 0.F}, KeyPose{half, 0.4F * seconds},
                                 KeyPose{perched, 0.8F * seconds}, KeyPose{sitting, seconds, false, false}});
}

Movement fidget(const Pose& base, std::span<const Pose> others, float seconds, Random& random) {
  Movement movement;
  movement.name = "fidget";
  movement.fps = kFps;
  const auto count = static_cast<std::size_t>(std::ceil(seconds * kFps)) + 1;
  Pose from = base;
  while (movement.states.size() < count) {
    const auto rest = int(between(0.3F, 2.F, random) * kFps);
    for (int i = 0; i < rest; ++i) movement.states.push_back({from, 0.F, Eigen::Vector2f::Zero()});
    const Pose to = draw_other(base, others, random);
    if (passes_through(from, to)) continue;
    const float least_s = largest_angle(from, to) / kMeanSpeed_rad_s;
    const int steps = int(std::max(0.4F, least_s * between(1.F, 1.6F, random)) * kFps);
    for (int i = 1; i <= steps; ++i) {
      const float share = smooth(float(i) / float(steps));
      movement.states.push_back({interpolated(from, to, share), 0.F, Eigen::Vector2f::Zero()});
    }
    from = to;
  }
  movement.states.resize(count);
  return movement;
}

}  // namespace vesalius::synth
