#include "synth/pose/joint_angles.h"

#include <gtest/gtest.h>

#include "synth/pose/pose.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

Vector3f direction(const Pose& pose, Bone bone) { return world_rotations(pose)[index(bone)] * rest_direction(bone); }
/// Returns the direction in which the palm faces; it is down in the T.
Vector3f palm(const Pose& pose, bool left) {
  return world_rotations(pose)[index(left ? Bone::l_hand : Bone::r_hand)] * -Vector3f::UnitY();
}
/// Expects directions of both arms; those of the right one are mirrored to the left.
void expect_arm(const ArmAngles& arm, const Vector3f& upper, const Vector3f& fore, const Vector3f& palm_normal) {
  BodyAngles angles;
  angles.arms = {arm, arm};
  const Pose pose = pose_of(angles);
  const Vector3f mirror_x(-1, 1, 1);
  EXPECT_LT((direction(pose, Bone::l_upper_arm) - upper).norm(), 1e-4F) << direction(pose, Bone::l_upper_arm);
  EXPECT_LT((direction(pose, Bone::l_forearm) - fore).norm(), 1e-4F) << direction(pose, Bone::l_forearm);
  EXPECT_LT((palm(pose, true) - palm_normal).norm(), 1e-4F) << palm(pose, true);
  EXPECT_LT((direction(pose, Bone::r_forearm) - fore.cwiseProduct(mirror_x)).norm(), 1e-4F);
  EXPECT_LT((palm(pose, false) - palm_normal.cwiseProduct(mirror_x)).norm(), 1e-4F);
}

const Vector3f kLeft = Vector3f::UnitX(), kUp = Vector3f::UnitY(), kFront = Vector3f::UnitZ();

TEST(JointAngles, TurnArmsAsInAnatomy) {
  expect_arm({.elevation = 0.F}, -kUp, -kUp, -kLeft);
  expect_arm({.elevation = 0.F, .elbow = 90.F}, -kUp, kFront, -kLeft);
  expect_arm({.elevation = 0.F, .pronation = 90.F}, -kUp, -kUp, -kFront);
  expect_arm({.elevation = 0.F, .external = 90.F, .elbow = 90.F}, -kUp, kLeft, kFront);
  expect_arm({.elevation = 90.F}, kLeft, kLeft, -kUp);  // the T
  expect_arm({.elevation = 90.F, .plane = 90.F, .elbow = 90.F}, kFront, kUp, -kLeft);
  expect_arm({.elevation = 30.F, .plane = -90.F}, Vector3f(0, -0.866025F, -0.5F), Vector3f(0, -0.866025F, -0.5F),
             -kLeft);
  expect_arm({.elevation = 90.F, .external = 90.F, .elbow = 90.F}, kLeft, kUp, kFront);
}

TEST(JointAngles, TurnLegsAndTrunkAsInAnatomy) {
  BodyAngles angles;
  angles.legs[0] = {.flexion = 90.F, .abduction = 0.F, .external = 0.F, .knee = 90.F, .ankle = 0.F};
  angles.legs[1] = {.flexion = 0.F, .abduction = 90.F};  // further than any leg, to show the direction
  angles.trunk.lateral = 90.F;
  const Pose pose = pose_of(angles);
  EXPECT_TRUE(direction(pose, Bone::l_thigh).isApprox(kFront, 1e-4F));
  EXPECT_TRUE(direction(pose, Bone::l_shin).isApprox(-kUp, 1e-4F));
  EXPECT_TRUE(direction(pose, Bone::l_foot).isApprox(kFront, 1e-4F));
  EXPECT_TRUE(direction(pose, Bone::r_thigh).isApprox(-kLeft, 1e-4F));
  EXPECT_TRUE(direction(pose, Bone::chest).isApprox(kLeft, 1e-4F));
  angles = {};
  angles.legs[0].external = 90.F;
  angles.legs[1].ankle = 90.F;
  angles.neck.turn = 90.F;
  const Pose turned = pose_of(angles);
  EXPECT_TRUE(direction(turned, Bone::l_foot).isApprox(kLeft, 1e-4F));
  EXPECT_TRUE(direction(turned, Bone::r_foot).isApprox(kUp, 1e-4F));
  EXPECT_TRUE((world_rotations(turned)[index(Bone::head)] * kFront).isApprox(kLeft, 1e-4F));
}

TEST(JointAngles, LayThePelvisDown) {
  BodyAngles angles;
  angles.pitch = -90.F;
  EXPECT_TRUE((pose_of(angles)[Bone::pelvis] * kFront).isApprox(kUp, 1e-4F)) << "on the back: looks up";
  angles = {};
  angles.roll = 90.F;
  EXPECT_TRUE((pose_of(angles)[Bone::pelvis] * kUp).isApprox(kLeft, 1e-4F)) << "on the left side";
}

TEST(JointAngles, OfArmsAreReadBack) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const auto between = [&](float low, float high) { return static_cast<float>(random.uniform(low, high)); };
    ArmAngles arm{between(15.F, 165.F), between(-90.F, 130.F), between(-90.F, 90.F), between(0.F, 150.F),
                  between(-80.F, 80.F), between(-70.F, 80.F),  between(-20.F, 30.F)};
    BodyAngles angles;
    angles.arms = {arm, arm};
    for (const bool left : {true, false}) {
      const ArmAngles read = arm_angles(pose_of(angles), left);
      EXPECT_NEAR(read.elevation, arm.elevation, 0.1F);
      EXPECT_NEAR(read.plane, arm.plane, 0.2F);
      EXPECT_NEAR(read.external, arm.external, 0.2F);
      EXPECT_NEAR(read.elbow, arm.elbow, 0.1F);
    }
    const ArmAngles straight_hand = [&] {
      angles.arms[0].ulnar = 0.F;
      return arm_angles(pose_of(angles), true);
    }();
    EXPECT_NEAR(straight_hand.pronation, arm.pronation, 0.2F);
    EXPECT_NEAR(straight_hand.wrist, arm.wrist, 0.2F);
  }
}

TEST(JointAngles, AreClampedToTheirRanges) {
  BodyAngles angles;
  angles.arms[0] = {.elevation = 170.F, .plane = -90.F, .elbow = 200.F, .pronation = -100.F};
  angles.legs[1].knee = -10.F;
  angles.grip[0] = 2.F;
  EXPECT_FALSE(arm_in_range(angles.arms[0]));
  const BodyAngles held = within_range(angles);
  EXPECT_FLOAT_EQ(held.arms[0].elevation, range::kExtension);
  EXPECT_EQ(held.arms[0].elbow, 150.F);
  EXPECT_EQ(held.legs[1].knee, 0.F);
  EXPECT_EQ(held.grip[0], 1.F);
  EXPECT_TRUE(arm_in_range(held.arms[0]));
  EXPECT_TRUE(arm_in_range(within_range({}).arms[1]));
}

TEST(Reach, PutsTheWristAtItsGoal) {
  BodyAngles angles;
  angles.trunk = {20.F, 10.F, 15.F};
  for (const bool left : {true, false}) {
    Pose pose = pose_of(angles);
    const Bone upper = left ? Bone::l_upper_arm : Bone::r_upper_arm, hand = left ? Bone::l_hand : Bone::r_hand;
    const Vector3f target = stick_figure(pose).head_of(upper) + Vector3f(left ? -0.1F : 0.1F, -0.2F, 0.25F);
    reach(pose, left, target, {left ? 1.F : -1.F, -1.F, 0.F});
    const StickFigure figure = stick_figure(pose);
    EXPECT_LT((figure.head_of(hand) - target).norm(), 1e-3F);
    const float elbow_x = figure.tail_of(upper).x() - figure.head_of(upper).x();
    EXPECT_GT(left ? elbow_x : -elbow_x, 0.F) << "the elbow points outwards";
    EXPECT_GT(arm_angles(pose, left).elbow, 0.F) << "and bends the right way";
  }
}

TEST(Reach, StretchesTheArmTowardsADistantGoal) {
  Pose pose = pose_of({});
  const Vector3f shoulder = stick_figure(pose).head_of(Bone::l_upper_arm);
  reach(pose, true, shoulder + Vector3f(0.F, 0.F, 3.F), -kUp);
  EXPECT_LT(arm_angles(pose, true).elbow, 10.F);
  EXPECT_GT(direction(pose, Bone::l_upper_arm).z(), 0.98F);
  for (const Vector3f& odd : {shoulder, Vector3f(shoulder + kUp)}) {
    reach(pose, true, odd, kUp);
    for (const Eigen::Quaternionf& q : pose.local) EXPECT_TRUE(q.coeffs().allFinite());
    EXPECT_LE(arm_angles(pose, true).elbow, 151.F);
  }
}

TEST(LegAngles, AreThoseOfThePose) {
  Random random(3);
  const auto in = [&](const JointRange& r) { return float(random.uniform(r.low, r.high)); };
  for (int i = 0; i < 50; ++i) {
    BodyAngles angles;
    for (LegAngles& leg : angles.legs) {
      leg = {in(range::kHipFlexion), in(range::kHipAbduction), in(range::kHipExternal), in(range::kKnee),
             in(range::kAnkle)};
    }
    const Pose pose = pose_of(angles);
    for (const bool left : {true, false}) {
      const LegAngles found = leg_angles(pose, left), &given = angles.legs[left ? 0 : 1];
      EXPECT_NEAR(found.flexion, given.flexion, 0.05F);
      EXPECT_NEAR(found.abduction, given.abduction, 0.05F);
      EXPECT_NEAR(found.external, given.external, 0.05F);
      EXPECT_NEAR(found.knee, given.knee, 0.05F);
      EXPECT_NEAR(found.ankle, given.ankle, 0.05F);
      EXPECT_TRUE(leg_in_range(found));
    }
  }
  EXPECT_FALSE(leg_in_range({.knee = 160.F}));
  EXPECT_FALSE(leg_in_range({.flexion = -40.F}));
}

TEST(PlaceAnkle, ReachesAPointWithTheKneeToTheFront) {
  for (const bool left : {true, false}) {
    Pose pose = pose_of({});
    const Vector3f ankle(left ? 0.15F : -0.15F, -0.6F, 0.2F);
    place_ankle(pose, left, ankle, Vector3f::UnitZ());
    slope_foot(pose, left, 0.F);
    const StickFigure figure = stick_figure(pose);
    EXPECT_LT((figure.head_of(left ? Bone::l_foot : Bone::r_foot) - ankle).norm(), 1e-3F);
    EXPECT_GT(figure.head_of(left ? Bone::l_shin : Bone::r_shin).z(), 0.2F);
    EXPECT_NEAR(direction(pose, left ? Bone::l_foot : Bone::r_foot).y(), 0.F, 1e-3F) << "a level sole";
    EXPECT_TRUE(leg_in_range(leg_angles(pose, left)));
  }
}

TEST(PointHand, TurnsFingersAndPalmAsFarAsTheWristAllows) {
  for (const bool left : {true, false}) {
    BodyAngles angles;
    for (ArmAngles& arm : angles.arms) arm = {.elevation = 20.F, .plane = 90.F, .elbow = 70.F};
    Pose pose = pose_of(angles);
    const Vector3f fingers(left ? -0.3F : 0.3F, 0.F, 1.F);
    point_hand(pose, left, fingers, -Vector3f::UnitY());
    EXPECT_GT(direction(pose, left ? Bone::l_hand : Bone::r_hand).dot(fingers.normalized()), 0.98F);
    EXPECT_GT(-palm(pose, left).y(), 0.95F);
    point_hand(pose, left, -fingers, Vector3f::UnitY());
    EXPECT_TRUE(arm_in_range(arm_angles(pose, left))) << "as far as it goes";
  }
}

}  // namespace
}  // namespace vesalius::synth
