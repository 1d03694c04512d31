#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "synth/pose/body_shapes.h"
#include "synth/pose/floor_contact.h"
#include "synth/pose/make_movements.h"
#include "synth/pose/pose_kinds.h"

/// Moments on the way from one posture to another. What carries the body at both ends of a stretch stays on the floor
/// meanwhile.
namespace vesalius::synth::kinds {
namespace {

using Eigen::Vector3f;

constexpr float kDegree = 3.14159265F / 180.F;

/// A pose on the way, and the limbs that carry it: hands that lie flat, feet that stand. [0] is left.
struct Stage {
  Pose pose;
  std::array<bool, 2> hands{}, feet{};
};

Bone hand_bone(bool left) { return left ? Bone::l_hand : Bone::r_hand; }
Bone foot_bone(bool left) { return left ? Bone::l_foot : Bone::r_foot; }

Vector3f mixed(const Vector3f& a, const Vector3f& b, float share) { return a + share * (b - a); }

/// Returns by how many degrees the foot rises to its toes.
float foot_rise(const Pose& pose, bool left) {
  const Vector3f along = world_rotations(pose)[index(foot_bone(left))] * Vector3f::UnitZ();
  return std::asin(std::clamp(along.y(), -1.F, 1.F)) / kDegree;
}

/// Returns the pose between two stages. Joints turn the shorter way; then legs and arms are set anew such that feet and
/// hands that carry at both ends stay on the floor, below a pelvis that goes straight from one place to the other.
Pose between_stages(const Stage& from, Stage to, float share) {
  to.pose = facing_as(to.pose, from.pose);
  Pose pose = interpolated(from.pose, to.pose, share);
  const StickFigure a = stick_figure(from.pose), b = stick_figure(to.pose), free = stick_figure(pose);
  for (std::size_t side = 0; side < 2; ++side) {
    const bool left = side == 0;
    const Bone foot = foot_bone(left), shin = parent(foot), hand = hand_bone(left), fore = parent(hand);
    if (from.feet[side] && to.feet[side]) {
      const Vector3f knee = free.head_of(shin) - 0.5F * (free.head_of(parent(shin)) + free.head_of(foot));
      place_ankle(pose, left, mixed(a.head_of(foot), b.head_of(foot), share), knee);
      slope_foot(pose, left, (1.F - share) * foot_rise(from.pose, left) + share * foot_rise(to.pose, left));
    }
    if (from.hands[side] && to.hands[side]) {
      const Eigen::Quaternionf wrist = pose[hand];
      const Vector3f elbow = free.head_of(fore) - 0.5F * (free.head_of(parent(fore)) + free.head_of(hand));
      reach(pose, left, mixed(a.head_of(hand), b.head_of(hand), share), elbow);
      pose[hand] = wrist;
    }
  }
  return pose;
}

void plant_beside(Stage& stage, bool left, const Vector3f& from_shoulder, const Vector3f& fingers) {
  stage.hands[left ? 0 : 1] = plant_below(stage.pose, left, from_shoulder, fingers);
}

Stage on_front(bool /*left*/, Random& random) {
  Stage stage{lie_on_front(random)};
  const float aside = between(random, 0.02F, 0.15F), behind = between(random, -0.2F, 0.F);
  for (const bool side : {true, false}) plant_beside(stage, side, {aside, 0.F, behind}, {0.2F, 0.F, 1.F});
  return stage;
}

Stage supine(bool /*left*/, Random& random) { return {lie_on_back(random)}; }

BodyAngles bent_legs(bool left, float pitch, Random& random) {
  BodyAngles angles;
  angles.pitch = pitch;
  for (std::size_t side = 0; side < 2; ++side) {
    const float rise = (side == 0) == left ? between(random, 0.F, 30.F) : between(random, 30.F, 55.F);
    angles.legs[side] = {.flexion = pitch + 90.F + rise, .abduction = between(random, 0.F, 15.F)};
    angles.legs[side].knee = knee_for_rise(rise);
    angles.legs[side].ankle = -20.F;
  }
  return angles;
}

Stage on_elbow(bool left, Random& random) {
  const float side = left ? 1.F : -1.F;
  BodyAngles angles = bent_legs(left, -40.F, random);
  angles.roll = side * between(random, 5.F, 20.F);
  angles.trunk = {between(random, 0.F, 15.F), side * between(random, 0.F, 20.F), -side * between(random, 0.F, 25.F)};
  angles.arms[left ? 1 : 0] = hanging_arm(random, between(random, 20.F, 60.F), 0.F);
  constexpr float kStep = 2.F, kLowest = -75.F;
  int spare = 3;
  for (;; angles.pitch -= kStep) {
    Stage stage{pose_of(within_range(angles))};
    const float floor = floor_y(stage.pose, false);
    const bool planted =
        plant_forearm(stage.pose, left, floor, on_side({1.F, 0.F, 0.2F}, left), on_side({0.4F, 0.F, 1.F}, left));
    if ((planted && spare-- == 0) || angles.pitch < kLowest) return stage;
    for (LegAngles& leg : angles.legs) leg.flexion -= kStep;
  }
}

Stage on_one_hand(bool left, Random& random) {
  BodyAngles angles = bent_legs(left, between(random, -30.F, -5.F), random);
  const float side = left ? 1.F : -1.F;
  angles.roll = side * between(random, 0.F, 15.F);
  angles.trunk = {between(random, 5.F, 25.F), side * between(random, 0.F, 15.F), side * between(random, 0.F, 20.F)};
  angles.arms[left ? 1 : 0] = hanging_arm(random, between(random, 20.F, 60.F), 0.F);
  Stage stage{pose_of(within_range(angles))};
  plant_beside(stage, left, {between(random, 0.05F, 0.2F), 0.F, between(random, -0.2F, 0.05F)}, {1.F, 0.F, 0.4F});
  return stage;
}

Stage seated_on_hands(bool /*left*/, Random& random) {
  BodyAngles angles;
  angles.pitch = between(random, -25.F, 0.F);
  angles.trunk.flexion = between(random, 5.F, 30.F);
  const float rise = between(random, 38.F, 56.F);
  for (LegAngles& leg : angles.legs) {
    leg = {.flexion = angles.pitch + 90.F + rise, .abduction = between(random, 2.F, 15.F)};
    leg.knee = knee_for_rise(rise);
    leg.ankle = level_ankle(leg, angles.pitch);
  }
  Stage stage{pose_of(within_range(angles)), {}, {true, true}};
  for (const bool left : {true, false}) {
    plant_beside(stage, left, {0.08F, 0.F, between(random, -0.2F, 0.1F)}, {0.6F, 0.F, 0.6F});
  }
  return stage;
}

Stage on_fours(bool /*left*/, Random& random) {
  BodyAngles angles;
  const float thigh = between(random, -8.F, 20.F);
  const float ahead = between(random, 0.F, 0.15F);
  for (angles.pitch = between(random, 66.F, 80.F);; angles.pitch += 3.F) {
    for (LegAngles& leg : angles.legs) {
      leg = {.flexion = angles.pitch + thigh, .abduction = 4.F};
      rest_on_knee(leg, thigh, true);
    }
    Stage stage{pose_of(within_range(angles))};
    for (const bool left : {true, false}) plant_beside(stage, left, {0.04F, 0.F, ahead}, {0.2F, 0.F, 1.F});
    if ((stage.hands[0] && stage.hands[1]) || angles.pitch > 100.F) return stage;
  }
}

/// Returns the angles of a leg whose foot stands flat before somebody on the other knee. The thigh is at an angle to
/// the vertical.
LegAngles front_leg(float pitch, float thigh, float hip_m) {
  const float knee_m = hip_m - bone_length_m(Bone::l_thigh) * std::cos(thigh * kDegree);
  const float lean = std::clamp((knee_m - kFlatAnkle_m) / bone_length_m(Bone::l_shin), 0.F, 1.F);
  LegAngles leg{.flexion = pitch + thigh, .abduction = 8.F, .knee = thigh + std::acos(lean) / kDegree};
  leg.ankle = level_ankle(leg, pitch);
  return leg;
}

/// How somebody is on one knee: angles of pelvis, trunk, and the thigh on whose knee the weight is.
struct HalfKneel {
  float pitch, flexion, thigh;
};

/// Returns somebody on one knee, whose other foot, left or right, is ahead.
Stage on_one_knee(bool left, const HalfKneel& kneel, Random& random) {
  constexpr float kKnee_m = 0.055F;
  BodyAngles angles;
  angles.pitch = kneel.pitch;
  angles.trunk.flexion = kneel.flexion;
  angles.neck.flexion = between(random, -0.4F, 0.1F) * kneel.flexion;
  const float hip_m = kKnee_m + bone_length_m(Bone::l_thigh) * std::cos(kneel.thigh * kDegree);
  LegAngles& rear = angles.legs[left ? 1 : 0];
  rear = {.flexion = kneel.pitch + kneel.thigh, .abduction = between(random, 2.F, 8.F)};
  rest_on_knee(rear, kneel.thigh, true);
  angles.legs[left ? 0 : 1] = front_leg(kneel.pitch, between(random, 88.F, 100.F), hip_m);
  for (ArmAngles& arm : angles.arms) {
    arm = hanging_arm(random, kneel.pitch + kneel.flexion + between(random, 0.F, 30.F), 8.F);
  }
  return {pose_of(within_range(angles)), {}, {true, true}};
}

Stage on_knee_and_hand(bool left, Random& random) {
  HalfKneel kneel{between(random, 12.F, 20.F), between(random, 50.F, 65.F), between(random, 20.F, 42.F)};
  const float ahead = between(random, 0.F, 0.12F);
  constexpr float kStep = 4.F;
  for (;; kneel.flexion += kStep) {
    Stage stage = on_one_knee(left, kneel, random);
    plant_beside(stage, !left, {0.05F, 0.F, ahead}, {0.2F, 0.F, 1.F});
    const bool planted = stage.hands[left ? 1 : 0];
    if (!planted && kneel.flexion < range::kTrunkFlexion.high) continue;
    if (chance(random, 0.4F)) {
      hand_on_thigh(stage.pose, left, random);
    } else {
      plant_beside(stage, left, {0.15F, 0.F, ahead}, {0.2F, 0.F, 1.F});
    }
    return stage;
  }
}

Stage on_knee(bool left, Random& random) {
  Stage stage =
      on_one_knee(left, {between(random, 0.F, 20.F), between(random, 5.F, 35.F), between(random, -10.F, 15.F)}, random);
  hand_on_thigh(stage.pose, left, random);
  return stage;
}

Stage on_both_knees(bool /*left*/, Random& random) {
  BodyAngles angles = standing_angles(random);
  angles.roll = 0.F;
  angles.pitch = between(random, -2.F, 12.F);
  angles.trunk.flexion = between(random, 0.F, 25.F);
  const float thigh = between(random, 8.F, 45.F);
  for (LegAngles& leg : angles.legs) {
    leg = {.flexion = angles.pitch + thigh, .abduction = between(random, 2.F, 10.F)};
    rest_on_knee(leg, thigh, true);
  }
  return {pose_of(within_range(angles))};
}

/// Puts both feet, one ahead of the other, under the middle of the body's weight, so far below the hips.
void stand_under(Stage& stage, bool left, float below_m, float apart_m, float heel_deg, Random& random) {
  constexpr float kFoot_m = 0.07F, kBall_m = 0.15F;  // from the ankle ahead to the middle of the foot and to its ball
  constexpr int kRounds = 3;
  const float aside = between(random, 0.1F, 0.17F);
  const float heel = std::sin(heel_deg * kDegree);
  for (int i = 0; i < kRounds; ++i) {
    const float weight = centre_of_mass(stick_figure(stage.pose)).z();
    for (const bool side : {true, false}) {
      const float ahead = weight - kFoot_m - 0.5F * heel * kFoot_m + (side == left ? 0.5F : -0.5F) * apart_m;
      place_ankle(stage.pose, side, on_side({aside, heel * kBall_m - below_m, ahead}, side), {0.F, 0.F, 1.F});
      slope_foot(stage.pose, side, -heel_deg);
    }
  }
  stage.feet = {true, true};
}

/// Returns somebody who stoops with one foot ahead and a hand on that knee.
Stage stooped(bool left, Random& random) {
  BodyAngles angles = standing_angles(random);
  angles.roll = 0.F;
  angles.pitch = between(random, 15.F, 45.F);
  angles.trunk.flexion = between(random, 10.F, 45.F);
  angles.neck.flexion = between(random, -35.F, 5.F);
  for (ArmAngles& arm : angles.arms) arm = hanging_arm(random, angles.pitch + between(random, 10.F, 50.F), 8.F);
  Stage stage{pose_of(within_range(angles))};
  const float below = between(random, 0.55F, 0.8F), apart = between(random, 0.F, 0.35F);
  stand_under(stage, left, below, apart, 0.F, random);
  hand_on_thigh(stage.pose, left, random);
  return stage;
}

Stage squatted(bool left, Random& random) {
  BodyAngles angles = standing_angles(random);
  angles.roll = 0.F;
  angles.pitch = between(random, 0.F, 25.F);
  angles.trunk.flexion = between(random, 25.F, 60.F);
  angles.neck.flexion = between(random, -35.F, 5.F);
  Stage stage{pose_of(within_range(angles))};
  const float below = between(random, 0.22F, 0.42F);
  stand_under(stage, left, below, between(random, 0.F, 0.12F), between(random, 0.F, 35.F), random);
  for (const bool side : {true, false}) {
    const Pose before = stage.pose;
    plant_beside(stage, side, {0.1F, 0.F, between(random, -0.15F, 0.2F)}, {0.5F, 0.F, 0.8F});
    if (stage.hands[side ? 0 : 1]) continue;
    stage.pose = before;
    hand_on_thigh(stage.pose, side, random);
  }
  return stage;
}

Stage standing(bool /*left*/, Random& random) { return {idle(random), {}, {true, true}}; }

using MakeStage = Stage (*)(bool left, Random&);
constexpr std::array<MakeStage, 6> kFromFront{on_front, on_fours, on_knee_and_hand, on_knee, stooped, standing};
constexpr std::array<MakeStage, 8> kFromBack{supine,           on_elbow, on_one_hand, on_fours,
                                             on_knee_and_hand, on_knee,  stooped,     standing};
constexpr std::array<MakeStage, 6> kOverSquat{supine, on_elbow, seated_on_hands, squatted, stooped, standing};
constexpr std::array<MakeStage, 4> kFromKnees{on_both_knees, on_knee, stooped, standing};

/// Returns whether what carries the body at both ends is on the floor, and its weight not so far from there that it
/// would not get on.
bool gets_on(const Stage& from, const Stage& to, const Pose& pose) {
  constexpr float kOnFloor_m = 0.03F, kMomentum_m = 0.1F;
  for (std::size_t side = 0; side < 2; ++side) {
    const bool left = side == 0;
    if (from.feet[side] && to.feet[side] && *skin_height_m(pose, foot_bone(left)) > kOnFloor_m) return false;
    if (from.hands[side] && to.hands[side] && *skin_height_m(pose, hand_bone(left)) > kOnFloor_m) return false;
  }
  return out_of_support_m(pose) < kMomentum_m;
}

/// Draws a moment, uniform in time, of a way that goes from stage to stage.
std::optional<Pose> moment(std::span<const MakeStage> way, Random& random) {
  constexpr float kMostTip = 5.F;
  const bool left = chance(random, 0.5F);
  const std::uint32_t stretch = random.below(static_cast<std::uint32_t>(way.size() - 1));
  const Stage from = way[stretch](left, random), to = way[stretch + 1](left, random);
  const Pose pose = between_stages(from, to, eased(between(random, 0.F, 1.F), false));
  if (!legs_in_range(pose)) return std::nullopt;
  Pose at_rest = pose;
  const bool rests = settle(at_rest) < kMostTip;
  const Pose& drawn = rests ? at_rest : pose;
  return gets_on(from, to, drawn) ? std::optional(drawn) : std::nullopt;
}

/// Lifts hands that are below the floor of trunk and legs.
void lift_hands(Pose& pose) {
  const float floor = floor_y(pose, false);
  const StickFigure figure = stick_figure(pose);
  for (const bool left : {true, false}) {
    Vector3f wrist = figure.head_of(hand_bone(left));
    if (wrist.y() >= floor + kFlatWrist_m) continue;
    wrist.y() = floor + kFlatWrist_m;
    reach(pose, left, wrist, Vector3f::UnitY());
  }
}

/// Lowers the leg that is nearer to the floor until its heel is there.
void lower_leg(Pose& pose) {
  constexpr float kHeel_m = 0.06F;
  const StickFigure figure = stick_figure(pose);
  const bool left = figure.head_of(Bone::l_foot).y() < figure.head_of(Bone::r_foot).y();
  const Bone foot = foot_bone(left), shin = parent(foot);
  Vector3f ankle = figure.head_of(foot);
  const Vector3f knee = figure.head_of(shin) - 0.5F * (figure.head_of(parent(shin)) + ankle);
  ankle.y() = floor_y(pose, false) + kHeel_m;
  place_ankle(pose, left, ankle, knee);
}

}  // namespace

std::optional<Pose> getting_up(Random& random) {
  switch (random.below(6)) {
    case 0:
    case 1:
      return moment(kFromFront, random);
    case 2:
    case 3:
      return moment(kFromBack, random);
    case 4:
      return moment(kOverSquat, random);
    default:
      return moment(kFromKnees, random);
  }
}

std::optional<Pose> turning_over(Random& random) {
  constexpr float kMostTip = 20.F;
  const Pose side = lie_on_side(random), flat = chance(random, 0.5F) ? lie_on_back(random) : lie_on_front(random);
  Pose pose = between_stages({side}, {flat}, eased(between(random, 0.F, 1.F), false));
  lift_hands(pose);
  if (settle_lengthwise(pose) > kMostTip) return std::nullopt;
  lower_leg(pose);
  return lies_on_trunk(pose) && legs_in_range(pose) ? std::optional(pose) : std::nullopt;
}

std::optional<Pose> falling(Random& random) {
  const Pose upright = idle(random), down = facing_as(lying(random), upright);
  const Movement fall = fall_down(upright, down, random);
  return state_at(fall, between(random, 0.3F, 1.F) * fall.seconds()).pose;
}

}  // namespace vesalius::synth::kinds
