#include <algorithm>
#include <cmath>

#include "synth/pose/pose_kinds.h"
#include "synth/pose/pose_sampler.h"

namespace vesalius::synth::kinds {
namespace {

using Eigen::Vector3f;

/// Returns somebody who stands, or sits on a seat with probability `seated`.
Pose upright(float seated, Random& random) {
  return chance(random, seated) ? sitting(random) : pose_of(standing_angles(random));
}

void turn_head(Pose& pose, const SpineAngles& neck) {
  BodyAngles angles;
  angles.neck = neck;
  pose = mix_limbs(pose, pose_of(within_range(angles)), {.head = true});
}

/// Bends the trunk by an angle more.
void bend_trunk(Pose& pose, float flexion_deg) {
  BodyAngles angles;
  angles.trunk.flexion = flexion_deg;
  const Pose bent = pose_of(angles);
  for (const Bone bone : {Bone::spine, Bone::chest}) pose[bone] = (pose[bone] * bent[bone]).normalized();
}

/// Moves a hand to a point of a bone and turns it in the chest's frame. All are given for the left side.
void lay_hand(Pose& pose, bool left, Bone bone, const Vector3f& offset_m, const Vector3f& fingers, const Vector3f& palm,
              Random& random) {
  reach_point(pose, left, bone, offset_m, {between(random, 0.7F, 1.3F), -0.8F, between(random, -0.4F, 0.1F)});
  const Eigen::Quaternionf chest = world_rotations(pose)[index(Bone::chest)];
  point_hand(pose, left, chest * on_side(fingers, left), chest * on_side(palm, left));
}

/// Clasps the hands at a point before the trunk, or rubs them: palms face each other, fingers point ahead.
void clasp(Pose& pose, const Vector3f& at_m, Random& random) {
  const bool left_above = chance(random, 0.5F);
  const float rub = between(random, 0.F, 0.035F), inwards = between(random, 0.3F, 0.8F);
  const float down = between(random, -0.6F, 0.2F), grip = between(random, 0.3F, 0.9F);
  for (const bool left : {true, false}) {
    const float sign = left == left_above ? 1.F : -1.F;
    const Vector3f wrist = Vector3f(0.065F, sign * 0.5F * rub, sign * 0.5F * rub) + on_side(at_m, left);
    lay_hand(pose, left, Bone::spine, wrist, {-inwards, down, 1.F}, {-1.F, 0.F, -0.3F}, random);
    set_grip(pose, left, grip);
  }
}

/// Lays one hand on the other with the palms to the belly or down.
void lay_together(Pose& pose, const Vector3f& at_m, bool palms_down, Random& random) {
  const bool left_outside = chance(random, 0.5F);
  const float apart = between(random, 0.05F, 0.11F);
  const Vector3f palm = palms_down ? Vector3f(0.F, -1.F, -0.2F) : Vector3f(0.F, -0.2F, -1.F);
  for (const bool left : {true, false}) {
    const float over = left == left_outside ? 0.04F : 0.F;
    const Vector3f wrist = Vector3f(apart, 0.F, 0.F) + on_side(at_m, left) - over * palm;
    lay_hand(pose, left, Bone::spine, wrist, {-1.F, between(random, -0.3F, 0.1F), between(random, 0.2F, 0.7F)}, palm,
             random);
    set_grip(pose, left, between(random, 0.2F, 0.6F));
  }
}

void pray(Pose& pose, Random& random) {
  const float height = between(random, 0.10F, 0.24F), far = between(random, 0.20F, 0.30F),
              ahead = between(random, 0.F, 0.8F);
  for (const bool left : {true, false}) {
    lay_hand(pose, left, Bone::spine, {0.03F, height, far}, {-0.05F, 1.F, ahead}, {-1.F, 0.F, 0.F}, random);
    set_grip(pose, left, 0.F);
  }
}

/// Lifts the shoulder, as raised arms do.
void lift_shoulder(Pose& pose, bool left) {
  BodyAngles angles;
  for (ArmAngles& arm : angles.arms) arm.shrug = 20.F;
  const Bone clavicle = left ? Bone::l_clavicle : Bone::r_clavicle;
  pose[clavicle] = pose_of(angles)[clavicle];
}

void hand_on_crown(Pose& pose, bool left, Random& random) {
  const Vector3f low(0.10F, 0.14F, 0.F), high(0.15F, 0.19F, 0.08F);
  lift_shoulder(pose, left);
  reach_point(pose, left, Bone::head, in_box(random, low, high), {1.F, 0.3F, between(random, 0.F, 0.5F)});
  set_hand(pose, left, between(random, -10.F, 30.F), between(random, 10.F, 50.F), 0.F);
  set_grip(pose, left, between(random, 0.F, 0.4F));
}

void hand_on_neck(Pose& pose, bool left, Random& random) {
  const Vector3f low(0.11F, -0.06F, -0.02F), high(0.15F, 0.02F, 0.04F);
  lift_shoulder(pose, left);
  reach_point(pose, left, Bone::head, in_box(random, low, high), {0.8F, -0.1F, between(random, 0.3F, 0.8F)});
  set_hand(pose, left, between(random, 0.F, 40.F), between(random, 0.F, 30.F), 0.F);
  set_grip(pose, left, between(random, 0.1F, 0.5F));
}

/// Holds the other upper arm or shoulder, or lies on the chest.
void hand_across(Pose& pose, bool left, Random& random) {
  const Vector3f low(-0.10F, -0.08F, 0.15F), high(0.02F, 0.12F, 0.17F);
  const Vector3f at = in_box(random, low, high), fingers(-1.F, between(random, -0.2F, 0.7F), 0.F);
  lay_hand(pose, left, Bone::chest, at, fingers, {0.F, 0.F, -1.F}, random);
  set_grip(pose, left, between(random, 0.1F, 0.5F));
}

void hand_on_knee(Pose& pose, bool left, Random& random) {
  const Vector3f low(-0.03F, -0.37F, 0.095F), high(0.03F, -0.30F, 0.115F);
  reach_point(pose, left, left ? Bone::l_thigh : Bone::r_thigh, in_box(random, low, high),
              {between(random, 0.4F, 1.F), 0.F, -0.6F});
  set_hand(pose, left, between(random, 20.F, 75.F), between(random, -10.F, 30.F), 0.F);
  set_grip(pose, left, between(random, 0.1F, 0.5F));
}

/// Returns somebody who sits with the elbows on the thighs: of all bends of the trunk the one at which upper arms end
/// there.
Pose elbows_on_knees(Random& random) {
  Pose pose = sitting(random);
  const float along = between(random, -0.36F, -0.24F), inwards = between(random, -0.03F, 0.03F);
  const auto elbow = [&](bool left) {
    return point_on(pose, left ? Bone::l_thigh : Bone::r_thigh, on_side({inwards, along, 0.105F}, left));
  };
  const auto shoulder = [&](bool left) {
    return stick_figure(pose).head_of(left ? Bone::l_upper_arm : Bone::r_upper_arm);
  };
  constexpr float kStep = 3.F, kMost = 60.F;
  for (float bent = 0.F; bent < kMost; bent += kStep) {
    if ((elbow(true) - shoulder(true)).norm() < bone_length_m(Bone::l_upper_arm)) break;
    bend_trunk(pose, kStep);
  }
  const Vector3f hand(between(random, -0.7F, -0.2F), between(random, -0.4F, 0.8F), 1.F);
  const bool both = chance(random, 0.8F), only_left = chance(random, 0.5F);
  for (const bool left : {true, false}) {
    if (!both && left != only_left) continue;
    const Vector3f to = elbow(left) - shoulder(left);
    const Vector3f forearm = bone_length_m(Bone::l_forearm) * on_side(hand, left).normalized();
    reach(pose, left, shoulder(left) + bone_length_m(Bone::l_upper_arm) * to.normalized() + forearm, to);
    set_hand(pose, left, between(random, -20.F, 50.F), between(random, -10.F, 40.F), 0.F);
    set_grip(pose, left, between(random, 0.2F, 0.7F));
  }
  turn_head(pose, {between(random, -35.F, 30.F), between(random, -8.F, 8.F), between(random, -30.F, 30.F)});
  return pose;
}

/// Returns somebody who stands with both hands on a table or a rail.
Pose hands_on_table_edge(Random& random) {
  BodyAngles angles = standing_angles(random);
  angles.roll = 0.F;
  angles.pitch = between(random, 8.F, 45.F);
  angles.trunk.flexion = between(random, 5.F, 35.F);
  angles.neck.flexion = between(random, -40.F, 25.F);
  for (LegAngles& leg : angles.legs) {
    leg.knee = between(random, 0.F, 15.F);
    leg.flexion = angles.pitch + 0.5F * leg.knee + between(random, -10.F, 2.F);
    leg.ankle = level_ankle(leg, angles.pitch);
  }
  Pose pose = pose_of(within_range(angles));
  const StickFigure figure = stick_figure(pose);
  const float drop = between(random, 0.42F, 0.55F), ahead = between(random, 0.F, 0.25F),
              apart = between(random, -0.02F, 0.18F);
  for (const bool left : {true, false}) {
    const Vector3f& shoulder = figure.head_of(left ? Bone::l_upper_arm : Bone::r_upper_arm);
    const Vector3f wrist = shoulder + on_side({apart, 0.F, ahead}, left);
    reach(pose, left, {wrist.x(), figure.head_of(Bone::l_upper_arm).y() - drop, wrist.z()},
          on_side({0.6F, 0.F, -1.F}, left));
    point_hand(pose, left, on_side({between(random, -0.3F, 0.8F), 0.F, 1.F}, left), {0.F, -1.F, 0.F});
    set_grip(pose, left, between(random, 0.F, 0.6F));
  }
  return pose;
}

}  // namespace

Pose drinking(Random& random) {
  Pose pose = upright(0.5F, random);
  const bool left = chance(random, 0.4F), both = chance(random, 0.25F), at_mouth = chance(random, 0.7F);
  turn_head(pose, {between(random, -25.F, 15.F), between(random, -6.F, 6.F), between(random, -25.F, 25.F)});
  const Vector3f low(0.02F, -0.09F, 0.16F), high(0.09F, -0.02F, 0.22F);
  const Vector3f held_low(0.F, -0.12F, 0.24F), held_high(0.12F, 0.08F, 0.34F);
  for (const bool side : {left, !left}) {
    if (side != left && !both) continue;
    const Vector3f at = at_mouth ? in_box(random, low, high) : in_box(random, held_low, held_high);
    reach_point(pose, side, at_mouth ? Bone::head : Bone::chest, at, {between(random, 0.3F, 1.3F), -1.F, 0.1F});
    set_hand(pose, side, between(random, -40.F, 15.F), between(random, 0.F, 30.F), between(random, -10.F, 20.F));
    set_grip(pose, side, between(random, 0.45F, 0.8F));
  }
  return pose;
}

Pose handing(Random& random) {
  Pose pose = upright(0.25F, random);
  bend_trunk(pose, between(random, 0.F, 20.F));
  const bool left = chance(random, 0.5F), both = chance(random, 0.35F);
  const Vector3f at = in_box(random, {0.F, -0.16F, 0.38F}, {0.28F, 0.12F, 0.56F});
  const float palm = between(random, -80.F, 30.F);
  for (const bool side : {left, !left}) {
    if (side != left && !both) continue;
    const Vector3f near = both ? Vector3f(0.5F * at.x() + 0.06F, at.y(), at.z()) : at;
    reach_point(pose, side, Bone::chest, near, {between(random, 0.4F, 1.F), -1.F, -0.2F});
    set_hand(pose, side, palm, between(random, -20.F, 25.F), between(random, -10.F, 15.F));
    set_grip(pose, side, between(random, 0.F, 0.7F));
  }
  return pose;
}

Pose hands_together(Random& random) {
  const float seat = between(random, 0.F, 1.F);
  Pose pose = seat < 0.4F ? pose_of(standing_angles(random)) : seat < 0.85F ? sitting(random) : floor_sitting(random);
  const bool stands = seat < 0.4F;
  switch (random.below(4)) {
    case 0:
      lay_together(pose, in_box(random, {-0.03F, -0.02F, 0.15F}, {0.03F, 0.12F, 0.18F}), false, random);
      break;
    case 1:
      clasp(pose, in_box(random, {-0.04F, -0.02F, 0.18F}, {0.04F, 0.16F, 0.28F}), random);
      break;
    case 2:
      pray(pose, random);
      break;
    default:
      if (stands) {
        clasp(pose, in_box(random, {-0.04F, -0.14F, 0.14F}, {0.04F, -0.04F, 0.20F}), random);
      } else {
        lay_together(pose, in_box(random, {-0.04F, -0.05F, 0.18F}, {0.04F, 0.02F, 0.26F}), true, random);
      }
  }
  return pose;
}

Pose touching_oneself(Random& random) {
  Pose pose = upright(0.65F, random);
  const bool left = chance(random, 0.5F), both = chance(random, 0.4F);
  const std::uint32_t what = random.below(6);
  if (what == 0) {
    cross_arms(pose, random);
    return pose;
  }
  for (const bool side : {left, !left}) {
    if (side != left && !both) continue;
    if (what == 1) hand_on_crown(pose, side, random);
    if (what == 2) hand_to_face(pose, side, random);
    if (what == 3) hand_on_neck(pose, side, random);
    if (what == 4) hand_across(pose, side, random);
    if (what == 5) hand_on_knee(pose, side, random);
  }
  return pose;
}

Pose leaning(Random& random) { return chance(random, 0.5F) ? elbows_on_knees(random) : hands_on_table_edge(random); }

}  // namespace vesalius::synth::kinds
