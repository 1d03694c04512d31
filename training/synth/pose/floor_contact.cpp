#include "synth/pose/floor_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "synth/pose/body_shapes.h"
#include "synth/pose/joint_angles.h"

namespace vesalius::synth {
namespace {

using Eigen::Quaternionf;
using Eigen::Vector3f;

constexpr float kDegree = 3.14159265F / 180.F;

/// A rounded end of a shape. The body's lowest point is always on one.
struct Ball {
  Bone bone;
  Vector3f centre;
  float radius_m;
};

std::vector<Ball> skin_of(const Pose& pose) {
  constexpr float kShoulder_m = 0.05F, kHeel_m = 0.035F;
  std::vector<Ball> balls;
  for (const BodyShape& shape : body_shapes(pose)) {
    balls.push_back({shape.bone, shape.from, shape.radius_m});
    balls.push_back({shape.bone, shape.to, shape.radius_m});
  }
  const StickFigure figure = stick_figure(pose);
  const auto world = world_rotations(pose);
  for (const Bone arm : {Bone::l_upper_arm, Bone::r_upper_arm}) {
    balls.push_back({arm, figure.head_of(arm), kShoulder_m});
  }
  for (const Bone foot : {Bone::l_foot, Bone::r_foot}) {  // heels, as low as the toes
    const Vector3f heel = figure.head_of(foot) + world[index(foot)] * Vector3f(0.F, kHeel_m - kFlatAnkle_m, -0.04F);
    balls.push_back({foot, heel, kHeel_m});
  }
  return balls;
}

float bottom(const Ball& ball) { return ball.centre.y() - ball.radius_m; }

bool is_arm(Bone bone) {
  return bone == Bone::l_upper_arm || bone == Bone::l_forearm || bone == Bone::l_hand || bone == Bone::r_upper_arm ||
         bone == Bone::r_forearm || bone == Bone::r_hand;
}

/// Returns the direction that comes to point downwards when the body tips over: going down from the present one, the
/// nearest at which the centre of mass is lowest above the lowest skin. The body tips away from the skin that carries
/// it alone, by steps that shrink and are smaller for high bodies, which stand on little. With `along`, it tips in the
/// plane of that direction and the vertical only.
Vector3f resting_down(const Pose& pose, const std::optional<Vector3f>& along) {
  constexpr int kSteps = 220;
  constexpr float kFirst = 1.5F * kDegree, kShrink = 0.975F, kLow_m = 0.25F, kLevel_m = 1e-4F;
  const std::vector<Ball> skin = skin_of(pose);
  const Vector3f weight = centre_of_mass(stick_figure(pose));
  Vector3f down = -Vector3f::UnitY();
  const auto depth = [&](const Ball& ball) { return down.dot(ball.centre - weight) + ball.radius_m; };
  float step = kFirst * std::min(1.F, kLow_m / depth(*std::ranges::max_element(skin, {}, depth)));
  for (int i = 0; i < kSteps; ++i, step *= kShrink) {
    const Ball& lowest = *std::ranges::max_element(skin, {}, depth);
    Vector3f lever = lowest.centre - weight;
    lever -= lever.dot(down) * down;
    if (along) lever = lever.dot(*along) * *along;
    if (lever.norm() < kLevel_m) break;
    down = (down - step * lever.normalized()).normalized();
  }
  return down;
}

float tip(Pose& pose, const std::optional<Vector3f>& along) {
  const Vector3f down = resting_down(pose, along);
  const Quaternionf turn = Quaternionf::FromTwoVectors(down, -Vector3f::UnitY());
  pose[Bone::pelvis] = (turn * pose[Bone::pelvis]).normalized();
  return turn.angularDistance(Quaternionf::Identity()) / kDegree;
}

}  // namespace

float floor_y(const Pose& pose, bool with_arms) {
  float lowest = std::numeric_limits<float>::max();
  for (const Ball& ball : skin_of(pose)) {
    if (with_arms || !is_arm(ball.bone)) lowest = std::min(lowest, bottom(ball));
  }
  return lowest;
}

std::optional<float> skin_height_m(const Pose& pose, Bone bone) {
  std::optional<float> lowest;
  for (const Ball& ball : skin_of(pose)) {
    if (ball.bone == bone) lowest = std::min(lowest.value_or(bottom(ball)), bottom(ball));
  }
  if (lowest) *lowest -= floor_y(pose);
  return lowest;
}

float out_of_support_m(const Pose& pose) {
  constexpr float kNear_m = 0.04F;
  constexpr int kDirections = 48;
  const std::vector<Ball> skin = skin_of(pose);
  const Vector3f weight = centre_of_mass(stick_figure(pose));
  const float floor = floor_y(pose);
  float furthest = std::numeric_limits<float>::lowest();
  for (int i = 0; i < kDirections; ++i) {
    const float angle = 360.F * kDegree * float(i) / float(kDirections);
    const Vector3f ahead(std::cos(angle), 0.F, std::sin(angle));
    float carried = std::numeric_limits<float>::lowest();
    for (const Ball& ball : skin) {
      if (bottom(ball) < floor + kNear_m) carried = std::max(carried, ahead.dot(ball.centre) + 0.5F * ball.radius_m);
    }
    furthest = std::max(furthest, ahead.dot(weight) - carried);
  }
  return furthest;
}

float settle(Pose& pose) { return tip(pose, {}); }

float settle_lengthwise(Pose& pose) {
  const StickFigure figure = stick_figure(pose);
  Vector3f along = figure.tail_of(Bone::chest) - figure.head_of(Bone::pelvis);
  along.y() = 0.F;
  return tip(pose, along.normalized());
}

bool plant_hand(Pose& pose, bool left, const Vector3f& at, const Vector3f& fingers) {
  constexpr float kLongest = 0.995F;
  const Bone upper = left ? Bone::l_upper_arm : Bone::r_upper_arm, fore = left ? Bone::l_forearm : Bone::r_forearm;
  const Vector3f wrist = at + kFlatWrist_m * Vector3f::UnitY();
  const Vector3f shoulder = stick_figure(pose).head_of(upper);
  const Quaternionf chest = world_rotations(pose)[index(Bone::chest)];
  const Vector3f outwards = chest * Vector3f(left ? 1.F : -1.F, 0.F, 0.F), behind = chest * -Vector3f::UnitZ();
  const std::array<Vector3f, 5> elbows = {0.5F * outwards - fingers, 0.5F * outwards + behind, outwards, behind,
                                          outwards - behind};
  for (const Vector3f& elbow : elbows) {
    reach(pose, left, wrist, elbow);
    point_hand(pose, left, fingers, -Vector3f::UnitY());
    if (arm_in_range(arm_angles(pose, left))) break;
  }
  return (wrist - shoulder).norm() < kLongest * (bone_length_m(upper) + bone_length_m(fore));
}

bool plant_forearm(Pose& pose, bool left, float floor_y, const Vector3f& elbow_towards, const Vector3f& hand_towards) {
  constexpr float kSlack_m = 0.01F;
  const Bone upper = left ? Bone::l_upper_arm : Bone::r_upper_arm, fore = left ? Bone::l_forearm : Bone::r_forearm;
  const float drop = stick_figure(pose).head_of(upper).y() - floor_y - kRestingElbow_m, length = bone_length_m(upper);
  const float aside = std::sqrt(std::max(0.F, length * length - drop * drop));
  const Vector3f to_elbow = aside * elbow_towards.normalized() - drop * Vector3f::UnitY();
  const Vector3f to_wrist = to_elbow + bone_length_m(fore) * hand_towards.normalized();
  reach(pose, left, stick_figure(pose).head_of(upper) + to_wrist, to_elbow);
  point_hand(pose, left, hand_towards, -Vector3f::UnitY());
  return drop > 0.F && drop < length + kSlack_m;
}

Pose facing_as(Pose pose, const Pose& other) {
  const Quaternionf& a = other[Bone::pelvis];
  const Quaternionf& b = pose[Bone::pelvis];
  const Quaternionf half_turned = Quaternionf(0.F, 0.F, 1.F, 0.F) * b;
  const float half = std::atan2(a.dot(half_turned), a.dot(b));
  pose[Bone::pelvis] = (Quaternionf(std::cos(half), 0.F, std::sin(half), 0.F) * b).normalized();
  return pose;
}

}  // namespace vesalius::synth
