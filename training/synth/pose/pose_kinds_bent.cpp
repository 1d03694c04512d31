#include <algorithm>
#include <cmath>

#include "synth/pose/floor_contact.h"
#include "synth/pose/judge_pose.h"
#include "synth/pose/pose_kinds.h"

namespace vesalius::synth::kinds {
namespace {

using Eigen::Vector3f;

/// Bends the trunk deep over knees that bend by an angle. The hips go back until the body would not tip over.
std::optional<Pose> bend_deep(float knees, Random& random) {
  BodyAngles angles = standing_angles(random);
  angles.roll = 0.F;
  angles.pitch = between(random, 25.F, 75.F);
  angles.trunk.flexion = between(random, 30.F, 80.F);
  angles.neck.flexion = between(random, -40.F, 20.F);
  for (ArmAngles& arm : angles.arms) {
    arm = hanging_arm(random, angles.pitch + angles.trunk.flexion + between(random, -10.F, 40.F), 8.F);
  }
  const float apart = between(random, 0.F, 20.F);
  constexpr float kStep = 2.F, kLeast = -12.F, kMost = 40.F, kTips = 3.F;
  for (float back = kLeast; back < kMost; back += kStep) {
    for (LegAngles& leg : angles.legs) {
      leg = {
          .flexion = angles.pitch + 0.5F * knees + back, .abduction = apart, .external = 0.5F * apart, .knee = knees};
      leg.ankle = level_ankle(leg, angles.pitch);
    }
    Pose pose = pose_of(within_range(angles));
    if (settle(pose) < kTips) return pose;
  }
  return std::nullopt;
}

/// Takes a hand to something that lies on the floor, or stands there and is not high.
void reach_down(Pose& pose, bool left, Random& random) {
  const StickFigure figure = stick_figure(pose);
  const Vector3f feet = 0.5F * (figure.head_of(Bone::l_foot) + figure.head_of(Bone::r_foot));
  const float height = chance(random, 0.6F) ? between(random, 0.04F, 0.12F) : between(random, 0.1F, 0.4F);
  const Vector3f off = on_side({between(random, -0.05F, 0.3F), 0.F, between(random, 0.15F, 0.45F)}, left);
  const Vector3f wrist(feet.x() + off.x(), floor_y(pose, false) + height, feet.z() + off.z());
  reach(pose, left, wrist, on_side({0.6F, 0.F, -1.F}, left));
  set_hand(pose, left, between(random, -20.F, 60.F), between(random, -10.F, 40.F), 0.F);
  set_grip(pose, left, between(random, 0.2F, 0.9F));
}

std::optional<Pose> take_from_floor(Random& random) {
  std::optional<Pose> pose;
  if (chance(random, 0.3F)) {
    pose = rested(squatting(random), 8.F);
  } else {
    pose = bend_deep(between(random, 5.F, 95.F), random);
  }
  if (!pose) return pose;
  const bool left = chance(random, 0.5F), both = chance(random, 0.4F);
  for (const bool side : {left, !left}) {
    if (side == left || both) {
      reach_down(*pose, side, random);
    } else if (chance(random, 0.5F)) {
      hand_on_thigh(*pose, side, random);
    }
  }
  return pose;
}

/// Takes both hands to a shoe.
void reach_shoe(Pose& pose, bool left_shoe, Random& random) {
  const float ahead = between(random, 0.04F, 0.12F), apart = between(random, 0.05F, 0.09F);
  const Vector3f shoe = point_on(pose, left_shoe ? Bone::l_foot : Bone::r_foot, {0.F, 0.07F, ahead});
  for (const bool left : {true, false}) {
    reach(pose, left, shoe + on_side({apart, between(random, 0.F, 0.05F), 0.F}, left),
          on_side({1.F, 0.2F, -0.5F}, left));
    set_hand(pose, left, between(random, -10.F, 40.F), between(random, 10.F, 50.F), 0.F);
    set_grip(pose, left, between(random, 0.5F, 0.9F));
  }
}

std::optional<Pose> tie_shoe_standing(Random& random) {
  std::optional<Pose> pose = bend_deep(between(random, 10.F, 80.F), random);
  if (pose) reach_shoe(*pose, chance(random, 0.5F), random);
  return pose;
}

std::optional<Pose> tie_shoe_on_knee(Random& random) {
  BodyAngles angles;
  angles.pitch = between(random, 15.F, 45.F);
  angles.trunk.flexion = between(random, 30.F, 70.F);
  angles.neck = {between(random, -20.F, 30.F), 0.F, between(random, -15.F, 15.F)};
  const std::size_t front = random.below(2);
  const float thigh = between(random, -5.F, 25.F), rise = between(random, 85.F, 108.F);
  for (std::size_t side = 0; side < 2; ++side) {
    LegAngles& leg = angles.legs[side];
    leg = {.flexion = angles.pitch + thigh, .abduction = between(random, 2.F, 10.F)};
    rest_on_knee(leg, thigh, chance(random, 0.7F));
  }
  LegAngles& ahead = angles.legs[front];
  ahead = {.flexion = angles.pitch + rise,
           .abduction = between(random, 5.F, 15.F),
           .knee = rise + between(random, 5.F, 25.F)};
  ahead.ankle = level_ankle(ahead, angles.pitch);
  Pose pose = pose_of(within_range(angles));
  reach_shoe(pose, front == 0, random);
  return rested(pose, 10.F);
}

std::optional<Pose> tie_shoe_seated(Random& random) {
  BodyAngles angles;
  angles.pitch = between(random, 15.F, 45.F);
  angles.trunk.flexion = between(random, 40.F, 80.F);
  angles.neck = {between(random, -25.F, 25.F), 0.F, between(random, -15.F, 15.F)};
  for (LegAngles& leg : angles.legs) {
    const float thigh = between(random, 82.F, 96.F);
    leg = {.flexion = angles.pitch + thigh,
           .abduction = between(random, 10.F, 32.F),
           .knee = thigh + between(random, -15.F, 15.F)};
    leg.ankle = level_ankle(leg, angles.pitch);
  }
  Pose pose = pose_of(within_range(angles));
  reach_shoe(pose, chance(random, 0.5F), random);
  return classify_posture(pose) == Posture::sitting ? std::optional(pose) : std::nullopt;
}

/// Looks under something: on knees and hands or forearms with the head low, or bent with the hands on the thighs.
std::optional<Pose> look_under(Random& random) {
  if (chance(random, 0.4F)) {
    std::optional<Pose> pose = bend_deep(between(random, 10.F, 70.F), random);
    if (!pose) return pose;
    for (const bool left : {true, false}) hand_on_thigh(*pose, left, random);
    return pose;
  }
  BodyAngles angles;
  angles.trunk = {between(random, -5.F, 35.F), between(random, -15.F, 15.F), between(random, -20.F, 20.F)};
  angles.neck = {between(random, -45.F, 0.F), between(random, -25.F, 25.F), between(random, -30.F, 30.F)};
  const float thigh = between(random, -5.F, 45.F), far = between(random, 0.05F, 0.3F);
  constexpr float kStep = 3.F, kMost = 120.F;
  for (angles.pitch = between(random, 75.F, 100.F); angles.pitch < kMost; angles.pitch += kStep) {
    for (LegAngles& leg : angles.legs) {
      leg = {.flexion = angles.pitch + thigh, .abduction = 5.F};
      rest_on_knee(leg, thigh, false);
    }
    Pose pose = pose_of(within_range(angles));
    bool planted = true;
    for (const bool left : {true, false}) {
      planted = plant_below(pose, left, {0.08F, 0.F, far}, {0.2F, 0.F, 1.F}) && planted;
    }
    if (planted) return rested(pose, 10.F);
  }
  return std::nullopt;
}

std::optional<Pose> pick_somehow(Random& random) {
  switch (random.below(7)) {
    case 0:
    case 1:
    case 2:
      return take_from_floor(random);
    case 3:
      return tie_shoe_standing(random);
    case 4:
      return tie_shoe_on_knee(random);
    case 5:
      return tie_shoe_seated(random);
    default:
      return look_under(random);
  }
}

}  // namespace

std::optional<Pose> picking_up(Random& random) {
  constexpr float kAlmost_m = 0.05F;  // arms that reach out shift the weight
  const std::optional<Pose> pose = pick_somehow(random);
  const bool holds = pose && (classify_posture(*pose) == Posture::sitting || out_of_support_m(*pose) < kAlmost_m);
  return holds ? pose : std::nullopt;
}

}  // namespace vesalius::synth::kinds
