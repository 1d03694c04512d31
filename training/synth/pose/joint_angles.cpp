#include "synth/pose/joint_angles.h"

#include <algorithm>
#include <cmath>

#include "synth/pose/pose.h"

namespace vesalius::synth {
namespace {

using Eigen::Quaternionf;
using Eigen::Vector3f;

constexpr float kDegree = 3.14159265F / 180.F;
/// Each bone of spine and neck takes half of its region's bend.
constexpr float kHalf = 0.5F;

Quaternionf turn(const Vector3f& axis, float degrees) {
  return Quaternionf(Eigen::AngleAxisf(degrees * kDegree, axis));
}
Quaternionf turn_x(float degrees) { return turn(Vector3f::UnitX(), degrees); }
Quaternionf turn_y(float degrees) { return turn(Vector3f::UnitY(), degrees); }
Quaternionf turn_z(float degrees) { return turn(Vector3f::UnitZ(), degrees); }

/// Mirrors (x -> -x) the left side's rotation for the right side.
Quaternionf on_side(const Quaternionf& left_rotation, bool left) {
  const Quaternionf& q = left_rotation;
  return left ? q : Quaternionf(q.w(), q.x(), -q.y(), -q.z());
}

/// Returns the turn of the upper arm from the T to the hanging position and then by `elevation` towards `plane`,
/// without a turn about its own axis.
Quaternionf swing(float elevation, float plane) {
  return turn_y(-plane) * turn_z(elevation) * turn_y(plane) * turn_z(-90.F);
}

Quaternionf spine_turn(const SpineAngles& spine, float share) {
  return turn_y(share * spine.turn) * turn_z(-share * spine.lateral) * turn_x(share * spine.flexion);
}

void set_arm(Pose& pose, bool left, const ArmAngles& arm) {
  pose[left ? Bone::l_clavicle : Bone::r_clavicle] = on_side(turn_y(-arm.forward) * turn_z(arm.shrug), left);
  pose[left ? Bone::l_upper_arm : Bone::r_upper_arm] =
      on_side(swing(arm.elevation, arm.plane) * turn_x(-arm.external), left);
  pose[left ? Bone::l_forearm : Bone::r_forearm] = on_side(turn_y(-arm.elbow), left);
  set_hand(pose, left, arm.pronation, arm.wrist, arm.ulnar);
}

void set_leg(Pose& pose, bool left, const LegAngles& leg) {
  pose[left ? Bone::l_thigh : Bone::r_thigh] =
      on_side(turn_x(-leg.flexion) * turn_z(leg.abduction) * turn_y(leg.external), left);
  pose[left ? Bone::l_shin : Bone::r_shin] = turn_x(leg.knee);
  pose[left ? Bone::l_foot : Bone::r_foot] = turn_x(-leg.ankle);
}

void clamp(float& angle, const JointRange& range) { angle = std::clamp(angle, range.low, range.high); }

/// Returns the largest elevation that the shoulder allows in a plane: the full one to the side and the front, and less
/// the further back the arm goes.
float largest_elevation(float plane) {
  const float back = std::clamp(-plane / 90.F, 0.F, 1.F);
  return range::kElevation.high + back * (range::kExtension - range::kElevation.high);
}

void clamp(ArmAngles& arm) {
  clamp(arm.plane, range::kPlane);
  arm.elevation = std::clamp(arm.elevation, 0.F, largest_elevation(arm.plane));
  clamp(arm.external, range::kArmExternal);
  clamp(arm.elbow, range::kElbow);
  clamp(arm.pronation, range::kPronation);
  clamp(arm.wrist, range::kWrist);
  clamp(arm.ulnar, range::kUlnar);
  clamp(arm.shrug, range::kShrug);
  clamp(arm.forward, range::kForward);
}

void clamp(LegAngles& leg) {
  clamp(leg.flexion, range::kHipFlexion);
  clamp(leg.abduction, range::kHipAbduction);
  clamp(leg.external, range::kHipExternal);
  clamp(leg.knee, range::kKnee);
  clamp(leg.ankle, range::kAnkle);
}

/// Returns the angle of a rotation about the x axis, in degrees in [-180, 180].
float x_angle(const Quaternionf& q) {
  const float angle = 2.F * std::atan2(q.x(), q.w()) / kDegree;
  return angle > 180.F ? angle - 360.F : angle < -180.F ? angle + 360.F : angle;
}

/// Two bones that end at a joint with a hinge between them.
struct ChainLengths {
  float first_m, second_m, most_bend_deg;
};

/// How they lie when their end is at a point, or as near to it as they reach.
struct Chain {
  Vector3f along;   ///< direction of the first bone
  Vector3f across;  ///< direction in which the second leaves it, at right angles to it
  float bend_deg;   ///< 0 is straight
};

Chain solve_chain(const ChainLengths& bones, const Vector3f& to, const Vector3f& hinge_towards) {
  const float a = bones.first_m, b = bones.second_m;
  const float nearest = std::sqrt(a * a + b * b - 2.F * a * b * std::cos((180.F - bones.most_bend_deg) * kDegree));
  const float d = std::clamp(to.norm(), nearest, (a + b) * 0.999F);
  const Vector3f n = to.norm() > 1e-4F ? to.normalized() : Vector3f(Vector3f::UnitZ());
  Vector3f pole = hinge_towards - hinge_towards.dot(n) * n;
  if (pole.norm() < 1e-4F) pole = n.unitOrthogonal();
  pole.normalize();
  const float cos_first = std::clamp((a * a + d * d - b * b) / (2.F * a * d), -1.F, 1.F);
  const Vector3f along = n * cos_first + pole * std::sqrt(1.F - cos_first * cos_first);
  const float cos_hinge = std::clamp((a * a + b * b - d * d) / (2.F * a * b), -1.F, 1.F);
  return {along, (n - n.dot(along) * along).normalized(), 180.F - std::acos(cos_hinge) / kDegree};
}

/// Two degrees of tolerance allow for rounding and for interpolation between two measurements.
bool in_range(float angle, const JointRange& range) {
  constexpr float kSlack = 2.F;
  return angle >= range.low - kSlack && angle <= range.high + kSlack;
}

}  // namespace

BodyAngles within_range(BodyAngles angles) {
  clamp(angles.trunk.flexion, range::kTrunkFlexion);
  clamp(angles.trunk.lateral, range::kTrunkLateral);
  clamp(angles.trunk.turn, range::kTrunkTurn);
  clamp(angles.neck.flexion, range::kNeckFlexion);
  clamp(angles.neck.lateral, range::kNeckLateral);
  clamp(angles.neck.turn, range::kNeckTurn);
  for (ArmAngles& arm : angles.arms) clamp(arm);
  for (LegAngles& leg : angles.legs) clamp(leg);
  for (float& grip : angles.grip) grip = std::clamp(grip, 0.F, 1.F);
  return angles;
}

Pose pose_of(const BodyAngles& angles) {
  Pose pose;
  pose[Bone::pelvis] = turn_z(-angles.roll) * turn_x(angles.pitch);
  pose[Bone::spine] = pose[Bone::chest] = spine_turn(angles.trunk, kHalf);
  pose[Bone::neck] = pose[Bone::head] = spine_turn(angles.neck, kHalf);
  for (const bool left : {true, false}) {
    set_arm(pose, left, angles.arms[left ? 0 : 1]);
    set_leg(pose, left, angles.legs[left ? 0 : 1]);
  }
  pose.l_grip = angles.grip[0];
  pose.r_grip = angles.grip[1];
  return pose;
}

ArmAngles arm_angles(const Pose& pose, bool left) {
  const Quaternionf upper = on_side(pose[left ? Bone::l_upper_arm : Bone::r_upper_arm], left);
  const Vector3f along = upper * Vector3f::UnitX();
  ArmAngles arm;
  arm.elevation = std::acos(std::clamp(-along.y(), -1.F, 1.F)) / kDegree;
  arm.plane = std::atan2(along.z(), along.x()) / kDegree;
  arm.external = -x_angle(swing(arm.elevation, arm.plane).conjugate() * upper);
  const Vector3f fore = on_side(pose[left ? Bone::l_forearm : Bone::r_forearm], left) * Vector3f::UnitX();
  arm.elbow = std::atan2(fore.z(), fore.x()) / kDegree;
  const Quaternionf hand = on_side(pose[left ? Bone::l_hand : Bone::r_hand], left);
  const Vector3f palm_axis = hand * Vector3f::UnitX();
  const Quaternionf bend = Quaternionf::FromTwoVectors(Vector3f::UnitX(), palm_axis);
  arm.pronation = x_angle(bend.conjugate() * hand);
  const Vector3f in_palm = turn_x(-arm.pronation) * palm_axis;
  arm.wrist = std::asin(std::clamp(-in_palm.y(), -1.F, 1.F)) / kDegree;
  arm.ulnar = std::atan2(-in_palm.z(), in_palm.x()) / kDegree;
  return arm;
}

bool arm_in_range(const ArmAngles& arm) {
  // A hanging arm points in no direction, so it has no plane.
  const bool raised = arm.elevation > 10.F;
  return (!raised || in_range(arm.plane, range::kPlane)) &&
         in_range(arm.elevation, {0.F, largest_elevation(arm.plane)}) && in_range(arm.external, range::kArmExternal) &&
         in_range(arm.elbow, range::kElbow) && in_range(arm.pronation, range::kPronation) &&
         in_range(arm.wrist, range::kWrist) && in_range(arm.ulnar, range::kUlnar);
}

LegAngles leg_angles(const Pose& pose, bool left) {
  const Eigen::Matrix3f thigh = on_side(pose[left ? Bone::l_thigh : Bone::r_thigh], left).toRotationMatrix();
  LegAngles leg;
  leg.flexion = -std::atan2(thigh(2, 1), thigh(1, 1)) / kDegree;
  leg.abduction = std::asin(std::clamp(-thigh(0, 1), -1.F, 1.F)) / kDegree;
  leg.external = std::atan2(thigh(0, 2), thigh(0, 0)) / kDegree;
  leg.knee = x_angle(pose[left ? Bone::l_shin : Bone::r_shin]);
  leg.ankle = -x_angle(pose[left ? Bone::l_foot : Bone::r_foot]);
  return leg;
}

bool leg_in_range(const LegAngles& leg) {
  return in_range(leg.flexion, range::kHipFlexion) && in_range(leg.abduction, range::kHipAbduction) &&
         in_range(leg.external, range::kHipExternal) && in_range(leg.knee, range::kKnee) &&
         in_range(leg.ankle, range::kAnkle);
}

void reach(Pose& pose, bool left, const Vector3f& wrist_m, const Vector3f& elbow_towards) {
  const Bone upper = left ? Bone::l_upper_arm : Bone::r_upper_arm;
  const Bone fore = left ? Bone::l_forearm : Bone::r_forearm;
  const Chain chain = solve_chain({bone_length_m(upper), bone_length_m(fore), range::kElbow.high},
                                  wrist_m - stick_figure(pose).head_of(upper), elbow_towards);
  Eigen::Matrix3f axes;  // the elbow bends towards the arm's own z
  axes.col(0) = left ? chain.along : Vector3f(-chain.along);
  axes.col(2) = chain.across;
  axes.col(1) = axes.col(2).cross(axes.col(0));
  const Quaternionf clavicle = world_rotations(pose)[index(parent(upper))];
  pose[upper] = (clavicle.conjugate() * Quaternionf(axes)).normalized();
  pose[fore] = on_side(turn_y(-chain.bend_deg), left);
  set_hand(pose, left, 0.F, 0.F, 0.F);
}

void place_ankle(Pose& pose, bool left, const Vector3f& ankle_m, const Vector3f& knee_towards) {
  const Bone thigh = left ? Bone::l_thigh : Bone::r_thigh, shin = left ? Bone::l_shin : Bone::r_shin;
  const Chain chain = solve_chain({bone_length_m(thigh), bone_length_m(shin), range::kKnee.high},
                                  ankle_m - stick_figure(pose).head_of(thigh), knee_towards);
  Eigen::Matrix3f axes;  // the knee bends away from the thigh's own z
  axes.col(1) = -chain.along;
  axes.col(2) = -chain.across;
  axes.col(0) = axes.col(1).cross(axes.col(2));
  pose[thigh] = (pose[Bone::pelvis].conjugate() * Quaternionf(axes)).normalized();
  pose[shin] = turn_x(chain.bend_deg);
}

void slope_foot(Pose& pose, bool left, float rise_deg) {
  const Quaternionf shin = world_rotations(pose)[index(left ? Bone::l_shin : Bone::r_shin)];
  const Vector3f up = shin.conjugate() * Vector3f::UnitY();
  float angle = std::atan2(-up.z(), up.y()) / kDegree + rise_deg;
  clamp(angle, range::kAnkle);
  pose[left ? Bone::l_foot : Bone::r_foot] = turn_x(-angle);
}

void point_hand(Pose& pose, bool left, const Vector3f& fingers, const Vector3f& palm) {
  Eigen::Matrix3f axes;
  axes.col(0) = (left ? fingers : Vector3f(-fingers)).normalized();
  axes.col(1) = (palm.dot(axes.col(0)) * axes.col(0) - palm).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  const Quaternionf forearm = world_rotations(pose)[index(left ? Bone::l_forearm : Bone::r_forearm)];
  // The angles of set_hand().
  const Eigen::Matrix3f hand = on_side(forearm.conjugate() * Quaternionf(axes), left).toRotationMatrix();
  float pronation = std::atan2(-hand(1, 2), hand(2, 2)) / kDegree, wrist = std::atan2(hand(0, 1), hand(0, 0)) / kDegree;
  float ulnar = std::asin(std::clamp(hand(0, 2), -1.F, 1.F)) / kDegree;
  clamp(pronation, range::kPronation);
  clamp(wrist, range::kWrist);
  clamp(ulnar, range::kUlnar);
  // A wrist that bends both ways at once bends less to either side.
  for (const float share : {1.F, 0.75F, 0.5F, 0.25F, 0.F}) {
    set_hand(pose, left, pronation, wrist, share * ulnar);
    const ArmAngles arm = arm_angles(pose, left);
    if (in_range(arm.pronation, range::kPronation) && in_range(arm.wrist, range::kWrist) &&
        in_range(arm.ulnar, range::kUlnar)) {
      return;
    }
  }
}

void set_hand(Pose& pose, bool left, float pronation, float wrist, float ulnar) {
  pose[left ? Bone::l_hand : Bone::r_hand] = on_side(turn_x(pronation) * turn_y(ulnar) * turn_z(-wrist), left);
}

}  // namespace vesalius::synth
