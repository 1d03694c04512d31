#include <algorithm>
#include <cmath>

#include "synth/pose/pose_kinds.h"

namespace vesalius::synth::kinds {
namespace {

constexpr float kDegree = 3.14159265F / 180.F;

/// Places the hands of a sitting person: in the lap, on a table or armrests, at a phone or the face, or crossed.
void seat_hands(Pose& pose, Random& random) {
  const std::uint32_t what = random.below(12);
  if (what == 0) return cross_arms(pose, random);
  if (what == 1) return phone_in_hand(pose, chance(random, 0.5F), random);
  for (const bool left : {true, false}) {
    if (what <= 6) {
      hand_on_thigh(pose, left, random);
    } else if (what <= 9) {
      hand_on_table(pose, left, random);
    }
  }
  if (chance(random, 0.15F)) hand_to_face(pose, chance(random, 0.5F), random);
  if (what == 11 && chance(random, 0.3F)) phone_to_ear(pose, chance(random, 0.5F), random);
}

/// Returns an arm on an armrest or hanging, before the hand is placed.
ArmAngles seat_arm(Random& random) {
  ArmAngles arm = hanging_arm(random, between(random, 0.F, 35.F), between(random, 10.F, 30.F));
  arm.elbow = between(random, 30.F, 95.F);
  arm.pronation = between(random, 0.F, 70.F);
  return arm;
}

/// Crosses the legs, knee on knee or ankle on knee.
void cross_legs(BodyAngles& angles, Random& random) {
  const std::size_t upper = random.below(2);
  LegAngles& over = angles.legs[upper];
  LegAngles& under = angles.legs[1 - upper];
  under.abduction = between(random, -4.F, 4.F);
  under.external = 0.F;
  if (chance(random, 0.5F)) {
    over.flexion = under.flexion + between(random, 13.F, 20.F);
    over.abduction = between(random, -20.F, -13.F);
    over.external = between(random, -5.F, 10.F);
    over.knee = between(random, 70.F, 100.F);
  } else {
    over.flexion = under.flexion + between(random, 0.F, 10.F);
    over.abduction = between(random, 30.F, 42.F);
    over.external = between(random, 38.F, 45.F);
    over.knee = between(random, 95.F, 120.F);
  }
  over.ankle = between(random, -25.F, 5.F);
}

BodyAngles seat_angles(Random& random) {
  BodyAngles angles;
  const bool leans_back = chance(random, 0.35F);
  angles.pitch = leans_back ? between(random, -40.F, -10.F) : between(random, -12.F, 15.F);
  angles.trunk = {between(random, -5.F, 35.F), between(random, -10.F, 10.F), between(random, -20.F, 20.F)};
  angles.neck = {between(random, -10.F, 30.F), between(random, -12.F, 12.F), between(random, -50.F, 50.F)};
  const bool stretched = chance(random, 0.25F);
  for (std::size_t side = 0; side < 2; ++side) {
    LegAngles& leg = angles.legs[side];
    const float thigh = between(random, 80.F, 100.F);  // angle from hanging down
    leg.flexion = angles.pitch + thigh;
    leg.abduction = between(random, 0.F, 25.F);
    leg.external = between(random, -10.F, 10.F);
    leg.knee = std::max(5.F, thigh + (stretched ? between(random, -75.F, -30.F) : between(random, -25.F, 20.F)));
    leg.ankle = stretched ? between(random, -25.F, 5.F) : level_ankle(leg, angles.pitch);
    angles.arms[side] = seat_arm(random);
    angles.grip[side] = between(random, 0.1F, 0.8F);
  }
  return angles;
}

Pose on_all_fours(Random& random) {
  BodyAngles angles;
  angles.pitch = between(random, 65.F, 85.F);
  angles.trunk.flexion = between(random, -5.F, 20.F);
  angles.neck = {between(random, -45.F, 10.F), 0.F, between(random, -30.F, 30.F)};
  const float chest = angles.pitch + angles.trunk.flexion;
  for (std::size_t side = 0; side < 2; ++side) {
    LegAngles& leg = angles.legs[side];
    const float thigh = between(random, -15.F, 25.F);
    leg.flexion = angles.pitch + thigh;
    leg.abduction = between(random, 0.F, 12.F);
    rest_on_knee(leg, thigh, false);
    ArmAngles& arm = angles.arms[side];
    arm = hanging_arm(random, chest + between(random, -15.F, 25.F), between(random, 0.F, 15.F));
    arm.elbow = between(random, 0.F, 20.F);
    arm.pronation = between(random, 40.F, 80.F);
    arm.wrist = -70.F;
    angles.grip[side] = 0.F;
  }
  return pose_of(within_range(angles));
}

}  // namespace

BodyAngles on_back(Random& random) {
  BodyAngles angles;
  angles.pitch = between(random, -95.F, -80.F);
  angles.trunk = {between(random, 0.F, 15.F), between(random, -10.F, 10.F), between(random, -10.F, 10.F)};
  angles.neck = {between(random, 0.F, 35.F), between(random, -10.F, 10.F), between(random, -50.F, 50.F)};
  const bool knees_up = chance(random, 0.35F);
  for (std::size_t side = 0; side < 2; ++side) {
    LegAngles& leg = angles.legs[side];
    const float rise = knees_up ? between(random, 10.F, 55.F) : between(random, 0.F, 8.F);
    leg.flexion = rise + 90.F + angles.pitch;
    leg.knee = knee_for_rise(rise);
    leg.abduction = between(random, 0.F, 20.F);
    leg.external = between(random, 0.F, 35.F);
    leg.ankle = knees_up ? between(random, -30.F, 0.F) : between(random, -45.F, -5.F);
    angles.arms[side] = hanging_arm(random, between(random, -3.F, 5.F), between(random, 8.F, 60.F));
    angles.grip[side] = between(random, 0.F, 0.6F);
  }
  return angles;
}

float knee_for_rise(float rise) {
  return rise + std::asin(std::clamp(std::sin(rise * kDegree) + 0.07F, -1.F, 1.F)) / kDegree;
}

void rest_on_knee(LegAngles& leg, float thigh, bool on_toes) {
  leg.knee = 90.F + thigh + (on_toes ? 17.F : 12.F);
  leg.ankle = on_toes ? 25.F : -50.F;
}

Pose sitting(Random& random) {
  BodyAngles angles = seat_angles(random);
  if (chance(random, 0.3F)) cross_legs(angles, random);
  Pose pose = pose_of(within_range(angles));
  seat_hands(pose, random);
  return pose;
}

Pose floor_sitting(Random& random) {
  BodyAngles angles = seat_angles(random);
  angles.pitch = between(random, -25.F, 5.F);
  angles.trunk.flexion = between(random, 10.F, 40.F);
  const bool tailor = chance(random, 0.4F);
  for (LegAngles& leg : angles.legs) {
    const float rise = tailor ? between(random, 8.F, 25.F) : between(random, 0.F, 50.F);
    leg.flexion = angles.pitch + 90.F + rise;
    leg.abduction = tailor ? between(random, 38.F, 45.F) : between(random, 0.F, 15.F);
    leg.external = tailor ? 45.F : between(random, -5.F, 15.F);
    leg.knee = tailor ? between(random, 115.F, 135.F) : knee_for_rise(rise);
    leg.ankle = tailor ? -30.F : between(random, -40.F, 0.F);
  }
  Pose pose = pose_of(within_range(angles));
  if (chance(random, 0.5F)) {
    for (const bool left : {true, false}) hand_on_thigh(pose, left, random);
  }
  return pose;
}

Pose lie_on_back(Random& random) {
  Pose pose = pose_of(within_range(on_back(random)));
  for (const bool left : {true, false}) {
    const std::uint32_t what = random.below(5);
    if (what == 0) hand_on_belly(pose, left, random);
    if (what == 1) hand_behind_head(pose, left, random);
  }
  return pose;
}

Pose lie_on_side(Random& random) {
  BodyAngles angles = on_back(random);
  angles.pitch = 0.F;
  angles.roll = between(random, 75.F, 105.F) * (chance(random, 0.5F) ? 1.F : -1.F);
  const std::size_t below = angles.roll > 0.F ? 0 : 1;
  const float bend = between(random, 10.F, 80.F);
  for (std::size_t side = 0; side < 2; ++side) {
    LegAngles& leg = angles.legs[side];
    leg.flexion = bend + between(random, -5.F, 25.F);
    leg.knee = leg.flexion + between(random, -10.F, 30.F);
    leg.abduction = between(random, -6.F, side == below ? 0.F : 10.F);
    leg.external = between(random, -5.F, 5.F);
    ArmAngles& arm = angles.arms[side];
    arm = hanging_arm(random, between(random, 35.F, 95.F), between(random, -10.F, 5.F));
    arm.elbow = between(random, 20.F, 110.F);
    arm.external = between(random, -30.F, 30.F);
  }
  if (chance(random, 0.4F)) angles.arms[1 - below] = hanging_arm(random, between(random, -10.F, 10.F), 3.F);
  angles.trunk.flexion = between(random, 0.F, 30.F);
  angles.neck.turn *= 0.4F;
  return pose_of(within_range(angles));
}

Pose lie_on_front(Random& random) {
  BodyAngles angles = on_back(random);
  angles.pitch = between(random, 84.F, 94.F);
  angles.trunk.flexion = between(random, -8.F, 0.F);
  angles.neck = {between(random, -30.F, 0.F), 0.F, between(random, 30.F, 60.F) * (chance(random, 0.5F) ? 1.F : -1.F)};
  for (std::size_t side = 0; side < 2; ++side) {
    LegAngles& leg = angles.legs[side];
    leg.flexion = angles.pitch - 90.F + between(random, -5.F, 3.F);
    leg.knee = chance(random, 0.2F) ? between(random, 20.F, 100.F) : between(random, 0.F, 15.F);
    leg.ankle = between(random, -50.F, -42.F);
    if (chance(random, 0.5F)) continue;  // otherwise a hand is beside or under the head
    ArmAngles& arm = angles.arms[side];
    arm.elevation = between(random, 90.F, 140.F);
    arm.plane = between(random, -20.F, 0.F);  // not below the bed
    arm.external = between(random, 60.F, 90.F);
    arm.elbow = between(random, 60.F, 130.F);
  }
  return pose_of(within_range(angles));
}

Pose lying(Random& random) {
  const std::uint32_t how = random.below(10);
  return how < 5 ? lie_on_back(random) : how < 8 ? lie_on_side(random) : lie_on_front(random);
}

Pose kneeling(Random& random) {
  if (chance(random, 0.2F)) return on_all_fours(random);
  BodyAngles angles = standing_angles(random);
  angles.roll = 0.F;
  angles.pitch = between(random, -5.F, 30.F);
  angles.trunk.flexion = between(random, 0.F, 40.F);
  const bool one_knee = chance(random, 0.5F);
  const float thigh =
      one_knee ? between(random, -15.F, 10.F) : between(random, 0.F, 50.F);  // degrees to the front of vertical
  const bool on_toes = chance(random, 0.5F);
  for (LegAngles& leg : angles.legs) {
    leg.flexion = angles.pitch + thigh;
    leg.abduction = between(random, 0.F, 12.F);
    leg.external = 0.F;
    rest_on_knee(leg, thigh, on_toes);
  }
  if (one_knee) {
    LegAngles& front = angles.legs[random.below(2)];
    front.flexion = angles.pitch + between(random, 82.F, 95.F);
    front.knee = front.flexion - angles.pitch + between(random, -15.F, 15.F);
    front.ankle = level_ankle(front, angles.pitch);
  }
  for (ArmAngles& arm : angles.arms) arm = hanging_arm(random, between(random, -5.F, 70.F), between(random, 3.F, 25.F));
  return pose_of(within_range(angles));
}

}  // namespace vesalius::synth::kinds
