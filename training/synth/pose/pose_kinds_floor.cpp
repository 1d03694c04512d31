#include <algorithm>
#include <cmath>

#include "synth/pose/floor_contact.h"
#include "synth/pose/pose_kinds.h"

namespace vesalius::synth::kinds {
namespace {

using Eigen::Vector3f;

/// Returns the angles of a leg of somebody who sits on the floor, whose knee is raised by an angle.
LegAngles floor_leg(float pitch, float rise, Random& random) {
  LegAngles leg;
  leg.flexion = pitch + 90.F + rise;
  leg.abduction = between(random, 0.F, 18.F);
  leg.external = between(random, -5.F, 25.F);
  leg.knee = knee_for_rise(rise);
  leg.ankle = between(random, -40.F, 5.F);
  return leg;
}

/// Stretches, bends or folds the legs of somebody who sits on the floor.
void floor_legs(BodyAngles& angles, Random& random) {
  const std::uint32_t how = random.below(4);
  for (std::size_t side = 0; side < 2; ++side) {
    const bool bent = how == 1 || (how == 2 && side == 0);
    angles.legs[side] = floor_leg(angles.pitch, bent ? between(random, 25.F, 55.F) : between(random, 0.F, 8.F), random);
    if (how != 3) continue;
    angles.legs[side] = floor_leg(angles.pitch, between(random, 8.F, 22.F), random);
    angles.legs[side].abduction = between(random, 38.F, 45.F);
    angles.legs[side].external = 45.F;
    angles.legs[side].knee = between(random, 112.F, 132.F);
  }
  if (how == 2 && chance(random, 0.5F)) std::swap(angles.legs[0], angles.legs[1]);
}

BodyAngles floor_trunk(float low_pitch, float high_pitch, Random& random) {
  BodyAngles angles;
  angles.pitch = between(random, low_pitch, high_pitch);
  angles.trunk = {between(random, -5.F, 25.F), between(random, -10.F, 10.F), between(random, -15.F, 15.F)};
  angles.neck = {between(random, -15.F, 35.F), between(random, -12.F, 12.F), between(random, -45.F, 45.F)};
  for (ArmAngles& arm : angles.arms) arm = hanging_arm(random, between(random, 5.F, 45.F), 15.F);
  return angles;
}

std::optional<Pose> sit_on_hands(Random& random) {
  BodyAngles angles = floor_trunk(-35.F, -6.F, random);
  floor_legs(angles, random);
  Pose pose = pose_of(within_range(angles));
  const float floor = floor_y(pose, false);
  const bool both = chance(random, 0.6F), only_left = chance(random, 0.5F);
  for (const bool left : {true, false}) {
    if (!both && left != only_left) {
      hand_on_thigh(pose, left, random);
      continue;
    }
    const Vector3f at = on_side({between(random, 0.16F, 0.38F), floor, between(random, -0.38F, -0.08F)}, left);
    const Vector3f fingers = on_side({between(random, 0.2F, 1.F), 0.F, between(random, -1.F, 0.4F)}, left);
    if (!plant_hand(pose, left, at, fingers)) return std::nullopt;
    set_grip(pose, left, between(random, 0.F, 0.25F));
  }
  return rested(pose, 12.F);
}

std::optional<Pose> sit_on_elbow(Random& random) {
  BodyAngles angles = floor_trunk(-45.F, -30.F, random);
  const bool both = chance(random, 0.3F), left = chance(random, 0.5F);
  const float side = left ? 1.F : -1.F;
  if (!both) {
    angles.roll = side * between(random, 0.F, 20.F);
    angles.trunk.lateral = side * between(random, 5.F, 30.F);
    angles.trunk.turn = -side * between(random, 0.F, 30.F);
  }
  floor_legs(angles, random);
  const Vector3f elbow(1.F, 0.F, between(random, -0.2F, 0.6F));
  const Vector3f hand(between(random, -0.3F, 0.8F), 0.F, 1.F);
  constexpr float kStep = 2.F, kLowest = -75.F;
  int spare = 1 + int(random.below(4));  // steps lower than need be, so that the elbow is beside the shoulder
  for (; angles.pitch > kLowest; angles.pitch -= kStep) {
    for (LegAngles& leg : angles.legs) leg.flexion -= kStep;
    Pose pose = pose_of(within_range(angles));
    const float floor = floor_y(pose, false);
    if (!plant_forearm(pose, left, floor, on_side(elbow, left), on_side(hand, left))) continue;
    if (both && !plant_forearm(pose, !left, floor, on_side(elbow, !left), on_side(hand, !left))) continue;
    if (spare-- > 0) continue;
    if (!both && chance(random, 0.6F)) hand_on_belly(pose, !left, random);
    return rested(pose, 12.F);
  }
  return std::nullopt;
}

/// Sits with stretched legs and the hands on the way to the feet.
std::optional<Pose> sit_long(Random& random) {
  BodyAngles angles = floor_trunk(-15.F, 12.F, random);
  angles.trunk.flexion = between(random, 5.F, 50.F);
  for (LegAngles& leg : angles.legs) leg = floor_leg(angles.pitch, between(random, 0.F, 6.F), random);
  Pose pose = pose_of(within_range(angles));
  const float far = between(random, -0.38F, -0.1F);
  for (const bool left : {true, false}) {
    reach_point(pose, left, left ? Bone::l_thigh : Bone::r_thigh, on_side({0.F, far, 0.10F}, left),
                {0.8F, -0.2F, -1.F});
    set_hand(pose, left, between(random, 30.F, 80.F), between(random, -10.F, 20.F), 0.F);
  }
  return rested(pose, 12.F);
}

/// Moves a hand to the side of a shin, its fingers over the front.
void hand_on_shin(Pose& pose, bool left, Bone shin, float down_m, float before_m, Random& random) {
  const Vector3f offset(0.075F, -down_m, before_m);
  reach_point(pose, left, shin, offset, {1.F, -0.2F, -0.3F});
  const Eigen::Quaternionf world = world_rotations(pose)[index(shin)];
  point_hand(pose, left, world * on_side({-1.F, 0.F, 0.4F}, left), world * Vector3f(0.F, 0.F, -1.F));
  set_grip(pose, left, between(random, 0.2F, 0.7F));
}

std::optional<Pose> hug_knees(Random& random) {
  BodyAngles angles = floor_trunk(-22.F, -4.F, random);
  angles.trunk.flexion = between(random, 25.F, 55.F);
  const float rise = between(random, 42.F, 58.F);
  for (LegAngles& leg : angles.legs) {
    leg = floor_leg(angles.pitch, rise, random);
    leg.abduction = between(random, 0.F, 6.F);
    leg.external = 0.F;
  }
  Pose pose = pose_of(within_range(angles));
  const float down = between(random, 0.05F, 0.2F);
  hand_on_shin(pose, true, Bone::l_shin, down, 0.06F, random);
  hand_on_shin(pose, false, Bone::r_shin, down + 0.03F, 0.09F, random);
  return rested(pose, 12.F);
}

/// Sits on one side with both shins to the other, perhaps leaning on a hand.
std::optional<Pose> sit_sideways(Random& random) {
  BodyAngles angles = floor_trunk(-10.F, 10.F, random);
  const std::size_t near = random.below(2);  // the side on which the weight is
  const bool left = near == 0;
  const float side = left ? 1.F : -1.F;
  angles.roll = side * between(random, 10.F, 25.F);
  angles.trunk.lateral = -side * between(random, 5.F, 25.F);
  LegAngles& under = angles.legs[near];
  LegAngles& over = angles.legs[1 - near];
  under = {.flexion = angles.pitch + between(random, 95.F, 112.F), .abduction = between(random, 34.F, 45.F)};
  under.external = 45.F;
  over = {.flexion = angles.pitch + between(random, 110.F, 122.F), .abduction = between(random, -10.F, 5.F)};
  over.external = -45.F;
  under.knee = between(random, 105.F, 132.F);
  over.knee = between(random, 132.F, 146.F);
  under.ankle = over.ankle = -40.F;
  Pose pose = pose_of(within_range(angles));
  if (settle(pose) > 40.F) return std::nullopt;
  const Vector3f off(between(random, 0.05F, 0.2F), 0.F, between(random, -0.1F, 0.15F));
  if (chance(random, 0.7F) && !plant_below(pose, left, off, {1.F, 0.F, 0.5F})) return std::nullopt;
  if (chance(random, 0.5F)) hand_on_thigh(pose, !left, random);
  return rested(pose, 10.F);
}

/// Returns the angles of somebody on the side, drawn up.
std::optional<Pose> curl_up(Random& random) {
  BodyAngles angles = on_back(random);
  angles.pitch = 0.F;
  angles.roll = between(random, 78.F, 100.F) * (chance(random, 0.5F) ? 1.F : -1.F);
  angles.trunk.flexion = between(random, 25.F, 60.F);
  angles.neck = {between(random, 10.F, 40.F), between(random, -8.F, 8.F), between(random, -10.F, 10.F)};
  const float thighs = between(random, 85.F, 115.F), knees = between(random, 90.F, 138.F);
  for (std::size_t side = 0; side < 2; ++side) {
    LegAngles& leg = angles.legs[side];
    leg = {.flexion = thighs + between(random, -8.F, 8.F), .abduction = between(random, 0.F, 5.F)};
    leg.knee = knees + between(random, -10.F, 10.F);
    leg.ankle = between(random, -35.F, 0.F);
    ArmAngles& arm = angles.arms[side];
    arm = hanging_arm(random, between(random, 35.F, 80.F), between(random, -5.F, 8.F));
    arm.elbow = between(random, 80.F, 140.F);
    arm.external = between(random, -20.F, 20.F);
  }
  Pose pose = pose_of(within_range(angles));
  if (chance(random, 0.3F)) {
    for (const bool left : {true, false}) {
      hand_on_shin(pose, left, left ? Bone::l_shin : Bone::r_shin, 0.12F, left ? 0.06F : 0.09F, random);
    }
  }
  return rested(pose, 35.F);
}

void arm_over_head(ArmAngles& arm, Random& random) {
  arm = {.elevation = between(random, 110.F, 172.F), .plane = between(random, -8.F, 10.F)};
  arm.external = between(random, 50.F, 90.F);
  arm.elbow = between(random, 0.F, 110.F);
  arm.pronation = between(random, -30.F, 30.F);
  arm.shrug = 0.1F * arm.elevation;
}

std::optional<Pose> lie_with_arms_over_head(Random& random) {
  BodyAngles angles = on_back(random);
  const bool both = chance(random, 0.6F);
  const std::size_t first = random.below(2);
  arm_over_head(angles.arms[first], random);
  if (both) arm_over_head(angles.arms[1 - first], random);
  if (chance(random, 0.4F)) {
    const float apart = between(random, 10.F, 40.F);
    for (LegAngles& leg : angles.legs) leg.abduction = apart;
  }
  return rested(pose_of(within_range(angles)), 15.F);
}

/// Lies on the back, one ankle on the other or on the knee that is raised.
std::optional<Pose> lie_with_legs_crossed(Random& random) {
  BodyAngles angles = on_back(random);
  const std::size_t upper = random.below(2);
  const bool stretched = chance(random, 0.5F);
  LegAngles& over = angles.legs[upper];
  LegAngles& under = angles.legs[1 - upper];
  const float rise = stretched ? 0.F : between(random, 38.F, 55.F), level = 90.F + angles.pitch;
  under = {.flexion = level + rise, .abduction = between(random, 0.F, 4.F)};
  under.knee = stretched ? 0.F : knee_for_rise(rise);
  if (stretched) {
    over = {.flexion = level + between(random, 7.F, 11.F), .abduction = between(random, -13.F, -8.F)};
    over.knee = between(random, 0.F, 5.F);
  } else {
    over = {.flexion = level + rise + between(random, 15.F, 35.F), .abduction = between(random, 28.F, 42.F)};
    over.external = between(random, 36.F, 45.F);
    over.knee = between(random, 92.F, 118.F);
  }
  over.ankle = under.ankle = between(random, -35.F, 0.F);
  Pose pose = pose_of(within_range(angles));
  for (const bool left : {true, false}) {
    if (chance(random, 0.3F)) hand_behind_head(pose, left, random);
    if (chance(random, 0.3F)) hand_on_belly(pose, left, random);
  }
  return rested(pose, 15.F);
}

std::optional<Pose> lie_with_knee_to_chest(Random& random) {
  BodyAngles angles = on_back(random);
  const bool both = chance(random, 0.3F);
  const std::size_t first = random.below(2);
  for (const std::size_t side : {first, 1 - first}) {
    if (side != first && !both) continue;
    LegAngles& leg = angles.legs[side];
    leg = {.flexion = between(random, 105.F, 120.F), .abduction = between(random, 0.F, 12.F)};
    leg.knee = between(random, 95.F, 145.F);
    leg.ankle = between(random, -30.F, 5.F);
  }
  angles.trunk.flexion = between(random, 5.F, 30.F);
  Pose pose = pose_of(within_range(angles));
  const float down = between(random, 0.02F, 0.15F);
  for (const bool left : {true, false}) {
    const bool own = left == (first == 0);
    const Bone shin = (both ? left : first == 0) ? Bone::l_shin : Bone::r_shin;
    if (both || own || chance(random, 0.6F)) hand_on_shin(pose, left, shin, down, own ? 0.05F : 0.08F, random);
  }
  return rested(pose, 20.F);
}

std::optional<Pose> lie_on_elbows(Random& random) {
  BodyAngles angles = on_back(random);
  angles.pitch = between(random, 82.F, 90.F);
  angles.trunk = {between(random, -25.F, -14.F), between(random, -6.F, 6.F), between(random, -8.F, 8.F)};
  angles.neck = {between(random, -40.F, 10.F), between(random, -8.F, 8.F), between(random, -35.F, 35.F)};
  for (LegAngles& leg : angles.legs) {
    leg = {.flexion = angles.pitch - 88.F, .abduction = between(random, 0.F, 18.F)};
    leg.external = between(random, 0.F, 25.F);
    leg.knee = chance(random, 0.3F) ? between(random, 30.F, 105.F) : between(random, 0.F, 10.F);
    leg.ankle = between(random, -50.F, -40.F);
  }
  const float apart = between(random, 0.F, 0.25F), inwards = between(random, -0.7F, 0.1F);
  constexpr float kStep = 2.F, kLeast = 62.F;
  for (; angles.pitch > kLeast; angles.pitch -= kStep) {
    for (LegAngles& leg : angles.legs) leg.flexion -= kStep;
    Pose pose = pose_of(within_range(angles));
    const float floor = floor_y(pose, false);
    bool planted = true;
    for (const bool left : {true, false}) {
      const Vector3f elbow = on_side({apart, 0.F, 0.3F}, left), hand = on_side({inwards, 0.F, 1.F}, left);
      planted = plant_forearm(pose, left, floor, elbow, hand) && planted;
    }
    if (planted) return rested(pose, 12.F);
  }
  return std::nullopt;
}

/// Lies between front and side, the upper knee before the body: the recovery position.
std::optional<Pose> lie_half_prone(Random& random) {
  BodyAngles angles = on_back(random);
  angles.pitch = 90.F;
  angles.trunk = {between(random, -5.F, 15.F), between(random, -8.F, 8.F), between(random, -10.F, 10.F)};
  const std::size_t upper = random.below(2);
  const float side = upper == 0 ? 1.F : -1.F;
  angles.neck = {between(random, -15.F, 15.F), 0.F, side * between(random, 0.F, 50.F)};
  LegAngles& over = angles.legs[upper];
  LegAngles& under = angles.legs[1 - upper];
  over = {.flexion = between(random, 45.F, 100.F), .abduction = between(random, 5.F, 35.F)};
  over.external = between(random, 0.F, 35.F);
  over.knee = between(random, 50.F, 110.F);
  under = {.flexion = between(random, -8.F, 15.F), .abduction = between(random, 0.F, 6.F)};
  under.knee = between(random, 0.F, 35.F);
  over.ankle = under.ankle = between(random, -50.F, -20.F);
  ArmAngles& arm = angles.arms[upper];
  arm = hanging_arm(random, between(random, 55.F, 110.F), between(random, 0.F, 30.F));
  arm.elbow = between(random, 60.F, 120.F);
  ArmAngles& other = angles.arms[1 - upper];
  if (chance(random, 0.5F))
    arm_over_head(other, random);
  else
    other = hanging_arm(random, between(random, -25.F, 0.F), between(random, 10.F, 30.F));
  Pose pose = pose_of(within_range(angles));
  const float lift = side * between(random, 20.F, 60.F) * 3.14159265F / 180.F;  // about the axis that the head is at
  pose[Bone::pelvis] = Eigen::Quaternionf(Eigen::AngleAxisf(lift, Vector3f::UnitZ())) * pose[Bone::pelvis];
  return rested(pose, 45.F);
}

/// Puts the hands of somebody on all fours on the floor, one of them perhaps on the way through the air.
bool plant_hands(Pose& pose, const std::array<float, 2>& ahead_m, const std::array<float, 2>& lift_m, Random& random) {
  bool planted = true;
  for (const bool left : {true, false}) {
    const std::size_t side = left ? 0 : 1;
    const Vector3f off(between(random, -0.04F, 0.1F), lift_m[side], ahead_m[side]);
    planted = plant_below(pose, left, off, {between(random, -0.3F, 0.6F), 0.F, 1.F}) && planted;
    set_grip(pose, left, between(random, 0.F, 0.3F));
  }
  return planted;
}

bool plant_forearms(Pose& pose, const std::array<float, 2>& ahead_m, Random& random) {
  const float floor = floor_y(pose, false);
  bool planted = true;
  for (std::size_t side = 0; side < 2; ++side) {
    const bool left = side == 0;
    const Vector3f elbow(between(random, 0.F, 0.1F), 0.F, 0.05F + ahead_m[side]);
    const Vector3f hand(between(random, -0.6F, 0.2F), 0.F, 1.F);
    planted = plant_forearm(pose, left, floor, on_side(elbow, left), on_side(hand, left)) && planted;
  }
  return planted;
}

/// Returns whether at most one of knees and hands is above the floor.
bool on_knees_and_hands(const Pose& pose) {
  constexpr float kOnFloor_m = 0.03F;
  int raised = 0;
  for (const bool left : {true, false}) {
    raised += *skin_height_m(pose, left ? Bone::l_hand : Bone::r_hand) > kOnFloor_m ? 1 : 0;
    raised += *skin_height_m(pose, left ? Bone::l_thigh : Bone::r_thigh) > kOnFloor_m ? 1 : 0;  // with the knee
  }
  return raised < 2;
}

std::optional<Pose> lie_somehow(Random& random) {
  switch (random.below(7)) {
    case 0:
    case 1:
      return curl_up(random);
    case 2:
      return lie_with_arms_over_head(random);
    case 3:
      return lie_with_legs_crossed(random);
    case 4:
      return lie_with_knee_to_chest(random);
    case 5:
      return lie_on_elbows(random);
    default:
      return lie_half_prone(random);
  }
}

}  // namespace

bool plant_below(Pose& pose, bool left, const Vector3f& off_m, const Vector3f& fingers) {
  Vector3f at = stick_figure(pose).head_of(left ? Bone::l_upper_arm : Bone::r_upper_arm) + on_side(off_m, left);
  at.y() = floor_y(pose, false) + off_m.y();
  return plant_hand(pose, left, at, on_side(fingers, left));
}

bool lies_on_trunk(const Pose& pose) {
  constexpr float kHips_m = 0.07F, kChest_m = 0.2F;  // a chest is that high above elbows
  return *skin_height_m(pose, Bone::pelvis) < kHips_m && *skin_height_m(pose, Bone::chest) < kChest_m;
}

bool legs_in_range(const Pose& pose) {
  return leg_in_range(leg_angles(pose, true)) && leg_in_range(leg_angles(pose, false));
}

std::optional<Pose> rested(Pose pose, float most_deg) {
  if (!legs_in_range(pose)) return std::nullopt;
  constexpr float kInBalance_m = 0.01F;
  if (settle(pose) > most_deg || out_of_support_m(pose) > kInBalance_m) return std::nullopt;
  return pose;
}

std::optional<Pose> crawling(Random& random) {
  const bool on_forearms = chance(random, 0.25F);
  const std::size_t ahead = random.below(2);
  const float stride = between(random, 0.F, 27.F);
  BodyAngles angles;
  angles.pitch = on_forearms ? between(random, 86.F, 94.F) : between(random, 64.F, 80.F);
  angles.trunk = {between(random, -8.F, 16.F), between(random, -8.F, 8.F), between(random, -6.F, 6.F)};
  angles.neck = {between(random, -45.F, 10.F), between(random, -8.F, 8.F), between(random, -40.F, 40.F)};
  const std::uint32_t lifted = random.below(6);  // 0: the knee ahead, 1: the hand ahead
  std::array<float, 2> ahead_m{}, lift_m{};
  std::array<float, 2> thighs{};
  for (std::size_t side = 0; side < 2; ++side) {
    const float sign = side == ahead ? 1.F : -1.F;
    thighs[side] = sign * stride;
    ahead_m[side] = between(random, -0.03F, 0.12F) - sign * 0.005F * stride;  // the other hand is ahead
    if (lifted == 1 && side != ahead) lift_m[side] = between(random, 0.02F, 0.12F);
  }
  const std::array<float, 2> raised{lifted == 0 && ahead == 0 ? between(random, 4.F, 18.F) : 0.F,
                                    lifted == 0 && ahead == 1 ? between(random, 4.F, 18.F) : 0.F};
  const bool on_toes = chance(random, 0.2F);
  const float apart = between(random, 0.F, 12.F);
  constexpr float kStep = 2.F, kMost = 112.F;
  for (; angles.pitch < kMost; angles.pitch += kStep) {
    for (std::size_t side = 0; side < 2; ++side) {
      LegAngles& leg = angles.legs[side];
      leg = {.flexion = angles.pitch + thighs[side] + raised[side], .abduction = apart};
      rest_on_knee(leg, thighs[side] + raised[side], on_toes);
      leg.knee += raised[side];
    }
    Pose pose = pose_of(within_range(angles));
    const bool planted =
        on_forearms ? plant_forearms(pose, ahead_m, random) : plant_hands(pose, ahead_m, lift_m, random);
    if (!planted) continue;
    const std::optional<Pose> crawls = rested(pose, 8.F);
    return crawls && on_knees_and_hands(*crawls) ? crawls : std::nullopt;
  }
  return std::nullopt;
}

std::optional<Pose> sitting_up(Random& random) {
  switch (random.below(6)) {
    case 0:
    case 1:
      return sit_on_hands(random);
    case 2:
      return sit_on_elbow(random);
    case 3:
      return sit_long(random);
    case 4:
      return hug_knees(random);
    default:
      return sit_sideways(random);
  }
}

std::optional<Pose> lying_varied(Random& random) {
  const std::optional<Pose> pose = lie_somehow(random);
  return pose && lies_on_trunk(*pose) ? pose : std::nullopt;
}

}  // namespace vesalius::synth::kinds
