#include "synth/pose/pose_kinds.h"
#include "synth/pose/stick_figure.h"

namespace vesalius::synth::kinds {

using Eigen::Vector3f;

float between(Random& random, float low, float high) { return float(random.uniform(low, high)); }

bool chance(Random& random, float probability) { return random.uniform() < probability; }

Vector3f on_side(const Vector3f& v, bool left) { return left ? v : Vector3f(-v.x(), v.y(), v.z()); }

Vector3f point_on(const Pose& pose, Bone bone, const Vector3f& offset_m) {
  return stick_figure(pose).head_of(bone) + world_rotations(pose)[index(bone)] * offset_m;
}

namespace {

/// Draws a point in a box, metres.
Vector3f in_box(Random& random, const Vector3f& low, const Vector3f& high) {
  const float x = between(random, low.x(), high.x()), y = between(random, low.y(), high.y());
  return {x, y, between(random, low.z(), high.z())};
}

/// Moves the wrist to a point that is fixed to a bone. The elbow's direction turns with the chest. Both are given for
/// the left side.
void reach_point(Pose& pose, bool left, Bone bone, const Vector3f& offset_m, const Vector3f& elbow_towards) {
  const Vector3f target = point_on(pose, bone, on_side(offset_m, left));
  const Eigen::Quaternionf chest = world_rotations(pose)[index(Bone::chest)];
  reach(pose, left, target, chest * on_side(elbow_towards, left));
}

void set_grip(Pose& pose, bool left, float grip) { (left ? pose.l_grip : pose.r_grip) = grip; }

}  // namespace

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

}  // namespace vesalius::synth::kinds
