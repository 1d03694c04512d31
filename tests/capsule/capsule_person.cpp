#include "capsule/capsule_person.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "vesalius/error.h"

namespace vesalius {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// In a body frame x points to the person's left, y up and z to the front. Lengths are fractions of the stature: Drillis
// and Contini, Body Segment Parameters, 1966.

// Lengths as fractions of the stature: Drillis and Contini, Body Segment Parameters, 1966.
constexpr double kAnkleHeight = 0.039, kKneeHeight = 0.285, kHipHeight = 0.530, kShoulderHeight = 0.818;
constexpr double kChinHeight = 0.870, kHeadHeight = 0.130;
constexpr double kShoulderBreadth = 0.259, kHipBreadth = 0.191;
constexpr double kUpperArm = 0.186, kForearm = 0.146, kHand = 0.108, kFoot = 0.152, kFootBreadth = 0.055;

// Radii are fractions of the stature. They are not in that table, but were set by eye.
constexpr double kUpperArmRadius = 0.028, kForearmRadius = 0.023, kThighRadius = 0.043, kLegRadius = 0.029;
constexpr double kNeckRadius = 0.034, kYokeRadius = 0.030, kFootRadius = 0.0195;
constexpr double kChestBreadth = 0.170, kTrunkDepth = 0.060, kTrunkRound = 0.050;

// The borders between parts.
constexpr double kWaistHeight = 0.620;                         // chest above, hips below
constexpr double kElbowSection = 0.030, kKneeSection = 0.035;  // on either side of the joint
constexpr double kHipJointX = 0.052;
/// Angle by which hanging arms keep clear of the hips. It decreases to 0 as the arm is raised.
constexpr double kRestRaise = 0.14;

Matrix3d about_x(double angle) { return Eigen::AngleAxisd(angle, Vector3d::UnitX()).toRotationMatrix(); }
Matrix3d about_y(double angle) { return Eigen::AngleAxisd(angle, Vector3d::UnitY()).toRotationMatrix(); }
Matrix3d about_z(double angle) { return Eigen::AngleAxisd(angle, Vector3d::UnitZ()).toRotationMatrix(); }

/// A position and orientation in the world.
struct Place {
  Matrix3d turn;
  Vector3d at;
  Vector3d operator()(double left, double up, double front) const { return at + turn * Vector3d(left, up, front); }
};

int part(const std::string& name) { return paper_body().find_part(name); }

class Builder {
 public:
  explicit Builder(const CapsulePerson& person)
      : build_(person.build), pose_(person.pose), stature_(person.build.stature_m), girth_(person.build.girth) {
    const Matrix3d world_from_body = Vector3d(1.0, -1.0, -1.0).asDiagonal();
    hips_.turn = world_from_body * about_y(pose_.yaw);
    hips_.at.setZero();
    place_feet(person.feet.cast<double>());
  }

  std::vector<BodySolid> build() {
    const Matrix3d lean = about_x(pose_.lean) * about_z(-pose_.side_lean);
    const Place trunk{hips_.turn * lean, hips_.at};
    add_trunk(trunk);
    add_head({trunk.turn, trunk(0.0, up(kChinHeight - 0.5 * kNeckRadius), 0.0)});
    for (const int side : {1, -1}) {
      add_arm(trunk, side);
      add_leg(side);
    }
    return std::move(solids_);
  }

 private:
  double length(double fraction) const { return fraction * stature_; }
  double radius(double fraction) const { return fraction * stature_ * girth_; }
  /// Returns the height above the hip joints of a point at this fraction of the stature.
  double up(double fraction) const { return length(fraction - kHipHeight); }

  const CapsulePose::Leg& leg(int side) const { return side > 0 ? pose_.l_leg : pose_.r_leg; }
  const CapsulePose::Arm& arm(int side) const { return side > 0 ? pose_.l_arm : pose_.r_arm; }
  static int sided(int side, const char* name) { return part((side > 0 ? "l_" : "r_") + std::string(name)); }

  Place thigh(int side) const {
    const Matrix3d turn = about_x(-leg(side).forward) * about_z(side * static_cast<double>(leg(side).spread));
    return {hips_.turn * turn, hips_(side * length(kHipJointX), 0.0, 0.0)};
  }
  Place shin(int side) const {
    const Place above = thigh(side);
    return {above.turn * about_x(leg(side).knee), above(0.0, -length(kHipHeight - kKneeHeight), 0.0)};
  }
  Vector3d ankle(int side) const { return shin(side)(0.0, -length(kKneeHeight - kAnkleHeight), 0.0); }

  /// Moves the hips such that the middle between the ankles is above `feet` and the lower sole is on the ground.
  void place_feet(const Vector3d& feet) {
    const Vector3d left = ankle(1), right = ankle(-1);
    const Vector3d middle = 0.5 * (left + right);
    const double lowest_y = std::max(left.y(), right.y()) + length(kAnkleHeight);
    hips_.at = feet - Vector3d(middle.x(), lowest_y, middle.z());
  }

  BodySolid& add(const Place& centre, const Vector3d& scale_m, double half_length_m, Rgb colour) {
    BodySolid solid;
    solid.shape = {centre.turn, centre.at, scale_m, std::max(0.0, half_length_m / scale_m.y())};
    solid.colour = solid.crown = colour;
    return solids_.emplace_back(solid);
  }

  static void set_parts(BodySolid& solid, int below, int above, double split = 0.0) {
    solid.part = {{{below, below}, {above, above}}};
    solid.split = split;
  }

  /// Adds a bone of a limb from `top` along -y. The last `section` of an upper bone, or the first of a lower bone,
  /// belongs to the joint.
  BodySolid& add_bone(const Place& top, double bone_m, double radius_m, Rgb colour) {
    return add({top.turn, top(0.0, -0.5 * bone_m, 0.0)}, Vector3d::Constant(radius_m), 0.5 * bone_m, colour);
  }
  void add_upper_bone(const Place& top, double bone_m, double radius_m, Rgb colour, int bone, int joint,
                      double section) {
    set_parts(add_bone(top, bone_m, radius_m, colour), joint, bone, (length(section) - 0.5 * bone_m) / radius_m);
  }
  void add_lower_bone(const Place& top, double bone_m, double radius_m, Rgb colour, int bone, int joint,
                      double section) {
    set_parts(add_bone(top, bone_m, radius_m, colour), bone, joint, (0.5 * bone_m - length(section)) / radius_m);
  }

  /// Adds a solid of the trunk between two heights, with hips below the waist and chest above.
  void add_trunk_solid(const Place& trunk, double low, double high, double breadth, Rgb colour) {
    const double middle = 0.5 * (low + high);
    const Vector3d scale(radius(0.5 * breadth), length(kTrunkRound), radius(kTrunkDepth));
    BodySolid& solid =
        add({trunk.turn, trunk(0.0, up(middle), 0.0)}, scale, length(0.5 * (high - low) - kTrunkRound), colour);
    solid.split = length(kWaistHeight - middle) / scale.y();
    solid.part = {{{part("r_hips"), part("l_hips")}, {part("r_chest"), part("l_chest")}}};
  }

  void add_trunk(const Place& trunk) {
    add_trunk_solid(trunk, 0.590, 0.822, kChestBreadth, build_.shirt);
    add_trunk_solid(trunk, 0.475, 0.655, kHipBreadth * 0.95, build_.trousers);
    // This is the yoke from shoulder to shoulder, whose axis points to the left.
    Matrix3d across;
    across.col(0) = -trunk.turn.col(1);
    across.col(1) = trunk.turn.col(0);
    across.col(2) = trunk.turn.col(2);
    BodySolid& yoke = add({across, trunk(0.0, up(kShoulderHeight - kYokeRadius), 0.0)},
                          Vector3d::Constant(radius(kYokeRadius)), shoulder_x(), build_.shirt);
    set_parts(yoke, part("r_chest"), part("l_chest"));
    const double neck = kChinHeight + 0.02 - kShoulderHeight;
    BodySolid& throat =
        add_bone({trunk.turn, trunk(0.0, up(kChinHeight + 0.02), 0.0)}, length(neck), radius(kNeckRadius), build_.skin);
    set_parts(throat, part("neck"), part("neck"));
  }

  double shoulder_x() const { return length(0.5 * kShoulderBreadth - kUpperArmRadius); }

  /// Adds the head, which turns on the neck at `base`.
  void add_head(const Place& base) {
    const Matrix3d turn = base.turn * about_y(pose_.head_yaw) * about_x(pose_.head_pitch);
    const Vector3d scale(length(0.043), length(0.5 * kHeadHeight), length(0.055));
    const Place head{turn, base.at};
    const Place centre{turn, head(0.0, length(0.5 * kNeckRadius) + scale.y(), 0.0)};
    BodySolid& skull = add(centre, scale, 0.0, build_.skin);
    skull.part = {{{part("r_face_bottom"), part("l_face_bottom")}, {part("r_face_top"), part("l_face_top")}}};
    skull.crown = build_.hair;
    const Vector3d nose_scale(length(0.010), length(0.016), length(0.014));
    BodySolid& nose = add({turn, centre(0.0, -0.25 * scale.y(), 0.97 * scale.z())}, nose_scale, 0.0, build_.skin);
    nose.part = skull.part;
    nose.split = 0.25 * scale.y() / nose_scale.y();
  }

  void add_arm(const Place& trunk, int side) {
    const CapsulePose::Arm& a = arm(side);
    const double raise = a.raise + kRestRaise * std::max(0.0, 1.0 - std::abs(a.raise) / (0.5 * std::numbers::pi));
    const Place upper{trunk.turn * about_x(-a.forward) * about_z(side * raise),
                      trunk(side * shoulder_x(), up(kShoulderHeight - kYokeRadius), 0.0)};
    const int elbow = sided(side, "elbow");
    add_upper_bone(upper, length(kUpperArm), radius(kUpperArmRadius), build_.shirt, sided(side, "upper_arm"), elbow,
                   kElbowSection);
    const Place lower{upper.turn * about_x(-a.elbow), upper(0.0, -length(kUpperArm), 0.0)};
    add_lower_bone(lower, length(kForearm), radius(kForearmRadius), build_.skin, sided(side, "forearm"), elbow,
                   kElbowSection);
    const Vector3d hand_scale(radius(0.016), length(0.5 * kHand), radius(0.024));
    const int hand = sided(side, "hand");
    set_parts(add({lower.turn, lower(0.0, -length(kForearm + 0.5 * kHand), 0.0)}, hand_scale, 0.0, build_.skin), hand,
              hand);
  }

  void add_leg(int side) {
    const int knee = sided(side, "knee");
    add_upper_bone(thigh(side), length(kHipHeight - kKneeHeight), radius(kThighRadius), build_.trousers,
                   sided(side, "thigh"), knee, kKneeSection);
    // The shin ends where its rounded end just does not touch the ground.
    const double shin_m = length(kKneeHeight) - std::max(length(kAnkleHeight), radius(kLegRadius));
    add_lower_bone(shin(side), shin_m, radius(kLegRadius), build_.trousers, sided(side, "leg"), knee, kKneeSection);
    add_foot(side);
  }

  /// Adds a level foot with its axis to the front. The heel is a quarter of its length behind the ankle.
  void add_foot(int side) {
    Matrix3d forward;
    forward.col(0) = -hips_.turn.col(0);
    forward.col(1) = hips_.turn.col(2);
    forward.col(2) = hips_.turn.col(1);
    const Vector3d scale(radius(0.5 * kFootBreadth), radius(0.5 * kFootBreadth), radius(kFootRadius));
    const Place at_ankle{hips_.turn, ankle(side)};
    const Vector3d centre = at_ankle(0.0, scale.z() - length(kAnkleHeight), length(0.25 * kFoot));
    const int foot = sided(side, "foot");
    set_parts(add({forward, centre}, scale, length(0.5 * kFoot) - scale.y(), build_.shoes), foot, foot);
  }

  const CapsuleBuild& build_;
  const CapsulePose& pose_;
  double stature_;
  double girth_;
  Place hips_;  ///< at the middle between the hip joints, turned by the yaw
  std::vector<BodySolid> solids_;
};

void check(const CapsulePerson& person) {
  const CapsulePose& p = person.pose;
  const auto outside = [](float value, float low, float high) { return !(value >= low && value <= high); };
  if (outside(person.build.stature_m, 0.5F, 2.5F)) {
    throw Error("capsule person: stature " + std::to_string(person.build.stature_m) + " m, expected 0.5 to 2.5");
  }
  if (outside(person.build.girth, 0.5F, 1.5F)) {
    throw Error("capsule person: girth " + std::to_string(person.build.girth) + ", expected 0.5 to 1.5");
  }
  const float angles[] = {p.yaw,           p.lean,          p.side_lean,   p.head_yaw,      p.head_pitch,
                          p.l_arm.raise,   p.l_arm.forward, p.l_arm.elbow, p.r_arm.raise,   p.r_arm.forward,
                          p.r_arm.elbow,   p.l_leg.spread,  p.l_leg.knee,  p.l_leg.forward, p.r_leg.spread,
                          p.r_leg.forward, p.r_leg.knee};
  if (!std::ranges::all_of(angles, [](float a) { return std::isfinite(a); }) || !person.feet.allFinite()) {
    throw Error("capsule person: pose and feet must be finite");
  }
}

}  // namespace

std::vector<BodySolid> make_solids(const CapsulePerson& person) {
  check(person);
  return Builder(person).build();
}

std::vector<Vector3d> part_centres(const std::vector<BodySolid>& solids) {
  const auto parts = static_cast<std::size_t>(paper_body().part_count());
  std::vector<Vector3d> moment(parts, Vector3d::Zero());
  std::vector<double> volume(parts, 0.0);
  for (const BodySolid& solid : solids) {
    const double end = solid.shape.half_length + 1.0;
    for (const int above : {0, 1}) {
      const Slab slab = measure_slab(solid.shape, above ? solid.split : -end, above ? end : solid.split);
      for (const int left : {0, 1}) {
        const auto p = static_cast<std::size_t>(solid.part[above][left]);
        moment[p] += slab.half_volume_m3 * solid.shape.world({left ? slab.x : -slab.x, slab.y, 0.0});
        volume[p] += slab.half_volume_m3;
      }
    }
  }
  for (std::size_t p = 0; p < parts; ++p) moment[p] /= volume[p];
  return moment;
}

}  // namespace vesalius
