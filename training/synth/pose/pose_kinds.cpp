#include "synth/pose/pose_kinds.h"

#include <algorithm>
#include <cmath>

namespace vesalius::synth::kinds {
namespace {

using Eigen::Vector3f;

constexpr float kPi = 3.14159265F;
constexpr float kDegree = kPi / 180.F;

/// Tilts the pelvis to the side until both feet are level, as far as the hips allow. The trunk compensates and stays
/// upright.
void level_feet(BodyAngles& angles) {
  constexpr float kMost = 10.F;
  const StickFigure figure = stick_figure(pose_of(angles));
  const Eigen::Vector3f between_feet = figure.head_of(Bone::l_foot) - figure.head_of(Bone::r_foot);
  const float width_m = std::max(std::abs(between_feet.x()), 0.19F);
  const float roll = std::clamp(std::atan2(between_feet.y(), width_m) / kDegree, -kMost, kMost);
  angles.roll += roll;
  angles.trunk.lateral -= roll;
}

/// Returns 1 at phase `at`, falling to 0 at the distance `width` on either side. Phases are shares of a stride.
float bump(float phase, float at, float width) {
  float away = std::abs(phase - at);
  away = std::min(away, 1.F - away);
  return away >= width ? 0.F : 0.5F + 0.5F * std::cos(kPi * away / width);
}

/// Returns the leg at a phase of the stride (0 is heel strike). The curve was fitted by eye to the sagittal curves of
/// normal gait at natural cadence: Winter, "The Biomechanics and Motor Control of Human Gait" (1991).
LegAngles stride(float phase, float length) {
  LegAngles leg;
  leg.flexion = length * (8.F + 22.F * std::cos(2.F * kPi * phase));
  leg.knee = 4.F + length * (14.F * bump(phase, 0.14F, 0.16F) + 58.F * bump(phase, 0.72F, 0.24F));
  leg.ankle = length * (9.F * bump(phase, 0.45F, 0.2F) - 18.F * bump(phase, 0.64F, 0.14F));
  return leg;
}

/// Swings an arm by so many degrees to the front and to the side.
void raise(ArmAngles& arm, float front, float side) {
  arm.elevation = std::hypot(front, side);
  arm.plane = std::atan2(front, side) / kDegree;
}

void fold_behind(Pose& pose, Random& random) {
  const bool left_outside = chance(random, 0.5F);
  const float height = between(random, -0.06F, 0.06F);
  for (const bool left : {true, false}) {
    const float depth = left == left_outside ? -0.205F : -0.155F;
    reach_point(pose, left, Bone::spine, {between(random, 0.F, 0.06F), height, depth}, {1.F, 0.F, -0.4F});
    set_hand(pose, left, between(random, -20.F, 20.F), between(random, -20.F, 20.F), 0.F);
    set_grip(pose, left, between(random, 0.2F, 0.8F));
  }
}

void put_on_hip(Pose& pose, bool left, Random& random) {
  const Vector3f low(0.20F, 0.08F, -0.06F), high(0.23F, 0.15F, 0.03F);
  reach_point(pose, left, Bone::pelvis, in_box(random, low, high), {1.F, 0.F, between(random, -0.7F, -0.1F)});
  set_hand(pose, left, between(random, 0.F, 60.F), between(random, -60.F, -10.F), between(random, -15.F, 15.F));
  set_grip(pose, left, between(random, 0.F, 0.9F));
}

void hold_in_front(Pose& pose, Random& random) {
  const float half_width = between(random, 0.10F, 0.24F), height = between(random, -0.02F, 0.25F);
  const float far = between(random, 0.26F, 0.40F), palms_up = between(random, -75.F, 10.F);
  for (const bool left : {true, false}) {
    reach_point(pose, left, Bone::spine, {half_width, height, far}, {0.5F, -1.F, -0.3F});
    set_hand(pose, left, palms_up, between(random, -10.F, 30.F), 0.F);
    set_grip(pose, left, between(random, 0.1F, 0.5F));
  }
}

}  // namespace

float between(Random& random, float low, float high) { return float(random.uniform(low, high)); }

bool chance(Random& random, float probability) { return random.uniform() < probability; }

Vector3f on_side(const Vector3f& v, bool left) { return left ? v : Vector3f(-v.x(), v.y(), v.z()); }

Vector3f point_on(const Pose& pose, Bone bone, const Vector3f& offset_m) {
  return stick_figure(pose).head_of(bone) + world_rotations(pose)[index(bone)] * offset_m;
}

Vector3f in_box(Random& random, const Vector3f& low, const Vector3f& high) {
  const float x = between(random, low.x(), high.x()), y = between(random, low.y(), high.y());
  return {x, y, between(random, low.z(), high.z())};
}

void reach_point(Pose& pose, bool left, Bone bone, const Vector3f& offset_m, const Vector3f& elbow_towards) {
  const Vector3f target = point_on(pose, bone, on_side(offset_m, left));
  const Eigen::Quaternionf chest = world_rotations(pose)[index(Bone::chest)];
  reach(pose, left, target, chest * on_side(elbow_towards, left));
}

void set_grip(Pose& pose, bool left, float grip) { (left ? pose.l_grip : pose.r_grip) = grip; }

void cross_arms(Pose& pose, Random& random) {
  const bool left_outside = chance(random, 0.5F);
  const float height = between(random, -0.08F, 0.03F);
  for (const bool left : {true, false}) {
    const bool outside = left == left_outside;
    const Vector3f offset(between(random, -0.10F, -0.05F), height + (outside ? -0.03F : 0.03F),
                          outside ? 0.20F : 0.155F);
    reach_point(pose, left, Bone::chest, offset, {0.7F, -1.F, 0.F});
    set_hand(pose, left, between(random, -20.F, 20.F), between(random, 0.F, 25.F), 0.F);
    set_grip(pose, left, between(random, 0.1F, 0.5F));
  }
}

void phone_to_ear(Pose& pose, bool left, Random& random) {
  const Vector3f low(0.12F, -0.07F, 0.05F), high(0.15F, -0.02F, 0.09F);
  reach_point(pose, left, Bone::head, in_box(random, low, high), {between(random, 0.6F, 1.4F), -1.F, 0.1F});
  set_hand(pose, left, between(random, -40.F, 20.F), between(random, 0.F, 15.F), between(random, -5.F, 25.F));
  set_grip(pose, left, between(random, 0.4F, 0.7F));
}

void phone_in_hand(Pose& pose, bool left, Random& random) {
  const Vector3f low(-0.02F, -0.16F, 0.24F), high(0.12F, 0.06F, 0.34F);
  reach_point(pose, left, Bone::chest, in_box(random, low, high), {0.5F, -1.F, -0.2F});
  set_hand(pose, left, between(random, -70.F, -30.F), between(random, 0.F, 30.F), 0.F);
  set_grip(pose, left, between(random, 0.4F, 0.7F));
}

void hand_on_thigh(Pose& pose, bool left, Random& random) {
  const Vector3f low(-0.05F, -0.28F, 0.10F), high(0.03F, -0.12F, 0.13F);
  reach_point(pose, left, left ? Bone::l_thigh : Bone::r_thigh, in_box(random, low, high),
              {between(random, 0.3F, 1.F), -0.3F, -1.F});
  set_hand(pose, left, between(random, 20.F, 80.F), between(random, -10.F, 30.F), 0.F);
  set_grip(pose, left, between(random, 0.1F, 0.6F));
}

void hand_on_table(Pose& pose, bool left, Random& random) {
  const Vector3f low(-0.02F, 0.20F, 0.34F), high(0.24F, 0.30F, 0.45F);
  reach_point(pose, left, Bone::pelvis, in_box(random, low, high), {1.F, -0.8F, -0.3F});
  set_hand(pose, left, between(random, 40.F, 80.F), between(random, -30.F, 10.F), between(random, -10.F, 15.F));
  set_grip(pose, left, between(random, 0.F, 0.7F));
}

void hand_to_face(Pose& pose, bool left, Random& random) {
  const Vector3f low(0.F, -0.12F, 0.17F), high(0.08F, -0.05F, 0.22F);
  reach_point(pose, left, Bone::head, in_box(random, low, high), {between(random, 0.2F, 0.8F), -1.F, 0.2F});
  set_hand(pose, left, between(random, -30.F, 30.F), between(random, 0.F, 50.F), 0.F);
  set_grip(pose, left, between(random, 0.1F, 0.9F));
}

void hand_behind_head(Pose& pose, bool left, Random& random) {
  const Vector3f low(0.09F, 0.04F, -0.11F), high(0.13F, 0.10F, -0.07F);
  reach_point(pose, left, Bone::head, in_box(random, low, high), {1.F, 0.3F, between(random, -0.2F, 0.6F)});
  set_hand(pose, left, between(random, -20.F, 20.F), between(random, 0.F, 30.F), 0.F);
  set_grip(pose, left, between(random, 0.F, 0.4F));
}

void hand_on_belly(Pose& pose, bool left, Random& random) {
  const Vector3f low(0.F, -0.02F, 0.14F), high(0.10F, 0.16F, 0.17F);
  reach_point(pose, left, Bone::spine, in_box(random, low, high), {1.F, -0.3F, -0.3F});
  set_hand(pose, left, between(random, -10.F, 30.F), between(random, 0.F, 30.F), 0.F);
  set_grip(pose, left, between(random, 0.F, 0.5F));
}

float level_ankle(const LegAngles& leg, float pitch) { return leg.knee - leg.flexion + pitch; }

ArmAngles hanging_arm(Random& random, float front, float side) {
  ArmAngles arm;
  raise(arm, front, side);
  arm.external = between(random, -35.F, 10.F);
  arm.elbow = between(random, 3.F, 30.F);
  arm.pronation = between(random, -10.F, 45.F);
  arm.wrist = between(random, -10.F, 20.F);
  arm.ulnar = between(random, -5.F, 15.F);
  return arm;
}

BodyAngles standing_angles(Random& random) {
  BodyAngles angles;
  angles.pitch = between(random, -4.F, 6.F);
  const int bent_leg = int(random.below(4));  // for 0 and 1 the weight is on the other leg
  for (int side = 0; side < 2; ++side) {
    LegAngles& leg = angles.legs[side];
    leg.abduction = between(random, 0.F, 12.F);
    leg.external = between(random, -5.F, 25.F);
    leg.knee = bent_leg == side ? between(random, 10.F, 35.F) : between(random, 0.F, 6.F);
    leg.flexion = angles.pitch + 0.55F * leg.knee + between(random, -6.F, 6.F);
    leg.ankle = level_ankle(leg, angles.pitch);
    angles.arms[side] = hanging_arm(random, between(random, -10.F, 12.F), between(random, 4.F, 16.F));
    angles.grip[side] = between(random, 0.1F, 0.7F);
  }
  angles.trunk = {between(random, -6.F, 10.F), between(random, -6.F, 6.F), between(random, -12.F, 12.F)};
  angles.neck = {between(random, -10.F, 20.F), between(random, -8.F, 8.F), between(random, -40.F, 40.F)};
  level_feet(angles);
  return within_range(angles);
}

Pose idle(Random& random) {
  Pose pose = pose_of(standing_angles(random));
  if (chance(random, 0.1F)) hand_to_face(pose, chance(random, 0.5F), random);
  if (chance(random, 0.05F)) {
    for (const bool left : {true, false}) hand_behind_head(pose, left, random);
  }
  return pose;
}

WalkStyle draw_walk(Random& random) {
  WalkStyle style;
  style.length = between(random, 0.5F, 1.3F);
  BodyAngles& angles = style.angles;
  angles = standing_angles(random);
  angles.pitch = between(random, 0.F, 8.F);
  angles.roll = between(random, -3.F, 3.F);
  angles.trunk = {between(random, -3.F, 6.F), -angles.roll, 0.F};
  for (std::size_t side = 0; side < 2; ++side) {
    const float outwards = angles.legs[side].external;
    angles.legs[side] = {};
    angles.legs[side].abduction = between(random, 0.F, 5.F);
    angles.legs[side].external = 0.5F * outwards;
    style.swing_deg[side] = between(random, 10.F, 25.F);
    style.side_deg[side] = between(random, 4.F, 14.F);
    angles.arms[side] = hanging_arm(random, 0.F, 0.F);
    style.elbow_deg[side] = between(random, 10.F, 25.F);
  }
  return style;
}

Pose walking_at(const WalkStyle& style, float phase) {
  BodyAngles angles = style.angles;
  angles.trunk.turn = style.length * 8.F * std::cos(2.F * kPi * phase);
  for (std::size_t side = 0; side < 2; ++side) {
    const float own = std::fmod(phase + 0.5F * float(side), 1.F);
    LegAngles& leg = angles.legs[side];
    const LegAngles swung = stride(own, style.length);
    leg.flexion = swung.flexion + angles.pitch;
    leg.knee = swung.knee;
    leg.ankle = swung.ankle;
    const float front = -style.length * style.swing_deg[side] * std::cos(2.F * kPi * own);
    raise(angles.arms[side], front + 5.F, style.side_deg[side]);
    angles.arms[side].elbow = style.elbow_deg[side] + std::max(front, 0.F);
  }
  return pose_of(within_range(angles));
}

Pose walking(Random& random) {
  const float phase = between(random, 0.F, 1.F);
  return walking_at(draw_walk(random), phase);
}

Pose reaching(Random& random) {
  BodyAngles angles = standing_angles(random);
  const std::size_t side = random.below(2);
  const float to_left = side == 0 ? 1.F : -1.F;
  for (std::size_t arm = 0; arm < 2; ++arm) {
    if (arm != side && !chance(random, 0.3F)) continue;
    ArmAngles& reaching_arm = angles.arms[arm];
    reaching_arm.elevation = between(random, 40.F, 170.F);
    reaching_arm.plane = between(random, -15.F, 110.F);
    reaching_arm.external = between(random, -40.F, 40.F);
    reaching_arm.elbow = between(random, 0.F, 60.F);
    reaching_arm.pronation = between(random, -50.F, 70.F);
    reaching_arm.wrist = between(random, -30.F, 30.F);
    reaching_arm.shrug = 0.12F * reaching_arm.elevation;
    reaching_arm.forward = between(random, 0.F, 15.F);
    angles.grip[arm] = between(random, 0.F, 1.F);
  }
  angles.trunk.turn += -to_left * between(random, -10.F, 30.F);
  angles.trunk.flexion += between(random, -10.F, 25.F);
  return pose_of(within_range(angles));
}

Pose waving(Random& random) {
  BodyAngles angles = standing_angles(random);
  const std::size_t side = random.below(2);
  ArmAngles& arm = angles.arms[side];
  arm.elevation = between(random, 45.F, 140.F);
  arm.plane = between(random, -5.F, 60.F);
  arm.external = between(random, 40.F, 90.F);
  arm.elbow = between(random, arm.elevation < 70.F ? 100.F : 40.F, 135.F);
  arm.pronation = between(random, -10.F, 40.F);
  arm.wrist = between(random, -25.F, 15.F);
  arm.shrug = between(random, 0.F, 12.F);
  angles.grip[side] = between(random, 0.F, 0.2F);
  if (chance(random, 0.15F)) angles.arms[1 - side] = arm;
  return pose_of(within_range(angles));
}

Pose bending(Random& random) {
  BodyAngles angles = standing_angles(random);
  angles.pitch = between(random, 10.F, 65.F);
  angles.roll = 0.F;
  angles.trunk.flexion = between(random, 10.F, 60.F);
  angles.neck.flexion = between(random, -35.F, 25.F);
  const float knees = between(random, 0.F, 70.F);
  for (LegAngles& leg : angles.legs) {
    leg.knee = std::max(0.F, knees + between(random, -10.F, 10.F));
    leg.flexion = angles.pitch + 0.5F * leg.knee + between(random, -8.F, 0.F);  // hips move back for balance
    leg.ankle = level_ankle(leg, angles.pitch);
  }
  const float chest = angles.pitch + angles.trunk.flexion;
  for (ArmAngles& arm : angles.arms) {
    arm = hanging_arm(random, chest + between(random, -25.F, 30.F), between(random, 2.F, 20.F));
    arm.elbow = between(random, 5.F, 60.F);
  }
  Pose pose = pose_of(within_range(angles));
  if (chance(random, 0.2F)) hand_on_thigh(pose, chance(random, 0.5F), random);
  return pose;
}

Pose arms_crossed(Random& random) {
  Pose pose = pose_of(standing_angles(random));
  cross_arms(pose, random);
  return pose;
}

Pose arms_behind(Random& random) {
  Pose pose = pose_of(standing_angles(random));
  fold_behind(pose, random);
  return pose;
}

Pose hands_on_hips(Random& random) {
  Pose pose = pose_of(standing_angles(random));
  const bool left = chance(random, 0.5F), both = chance(random, 0.7F);
  put_on_hip(pose, left, random);
  if (both) put_on_hip(pose, !left, random);
  return pose;
}

Pose carrying(Random& random) {
  const bool walks = chance(random, 0.4F);
  Pose pose = walks ? walking(random) : pose_of(standing_angles(random));
  if (chance(random, 0.65F)) {
    hold_in_front(pose, random);
    return pose;
  }
  const bool left = chance(random, 0.5F), both = chance(random, 0.3F);  // as if bags hung from the hands
  if (left || both) pose.l_grip = 1.F;
  if (!left || both) pose.r_grip = 1.F;
  return pose;
}

Pose phone(Random& random) {
  const bool ear = chance(random, 0.4F), left = chance(random, 0.5F), both = !ear && chance(random, 0.3F);
  BodyAngles angles = standing_angles(random);
  if (!ear) {
    angles.neck.flexion = between(random, 15.F, 40.F);
    angles.neck.turn *= 0.3F;
  }
  Pose pose = pose_of(within_range(angles));
  if (ear) {
    phone_to_ear(pose, left, random);
    return pose;
  }
  phone_in_hand(pose, left, random);
  if (both) phone_in_hand(pose, !left, random);
  return pose;
}

Pose squatting(Random& random) {
  BodyAngles angles = standing_angles(random);
  angles.roll = 0.F;
  angles.pitch = between(random, 5.F, 45.F);
  angles.trunk.flexion = between(random, 10.F, 45.F);
  angles.neck.flexion = between(random, -40.F, 10.F);
  const float thigh = between(random, 60.F, 110.F), shin = between(random, 15.F, 35.F);
  const float apart = between(random, 5.F, 30.F);
  for (LegAngles& leg : angles.legs) {
    leg.flexion = angles.pitch + thigh;
    leg.abduction = apart;
    leg.external = between(random, 0.F, 15.F);
    leg.knee = thigh + shin;
    leg.ankle = level_ankle(leg, angles.pitch);
  }
  for (ArmAngles& arm : angles.arms)
    arm = hanging_arm(random, between(random, 30.F, 100.F), between(random, 0.F, 25.F));
  return pose_of(within_range(angles));
}

Pose any(Random& random) {
  const auto in = [&](const JointRange& r) { return between(random, r.low, r.high); };
  BodyAngles angles;
  angles.pitch = between(random, -15.F, 40.F);
  angles.roll = between(random, -12.F, 12.F);
  angles.trunk = {in(range::kTrunkFlexion), in(range::kTrunkLateral), in(range::kTrunkTurn)};
  angles.neck = {in(range::kNeckFlexion), in(range::kNeckLateral), in(range::kNeckTurn)};
  for (ArmAngles& arm : angles.arms) {
    arm = {in(range::kElevation), in(range::kPlane), in(range::kArmExternal), in(range::kElbow),  in(range::kPronation),
           in(range::kWrist),     in(range::kUlnar), in(range::kShrug),       in(range::kForward)};
  }
  for (LegAngles& leg : angles.legs) {
    leg = {in(range::kHipFlexion), in(range::kHipAbduction), in(range::kHipExternal), in(range::kKnee),
           in(range::kAnkle)};
  }
  for (float& grip : angles.grip) grip = between(random, 0.F, 1.F);
  return pose_of(within_range(angles));
}

}  // namespace vesalius::synth::kinds
