#include "synth/pose/judge_pose.h"

#include <gtest/gtest.h>

#include "synth/pose/joint_angles.h"
#include "synth/pose/pose.h"

namespace vesalius::synth {
namespace {

BodyAngles legs(float flexion, float knee, float ankle = 0.F) {
  BodyAngles angles;
  for (LegAngles& leg : angles.legs) leg = {.flexion = flexion, .knee = knee, .ankle = ankle};
  return angles;
}

Posture posture_of(const BodyAngles& angles) { return classify_posture(pose_of(angles)); }

TEST(ClassifyPosture, FindsStandingPeopleByFeetUnderTheirWeight) {
  EXPECT_EQ(posture_of({}), Posture::standing);
  BodyAngles bent = legs(80.F, 10.F, 10.F);
  bent.pitch = 70.F;
  EXPECT_EQ(posture_of(bent), Posture::standing) << "a level trunk over straight legs is bent, not lying";
  BodyAngles squat = legs(130.F, 125.F, 30.F);
  squat.pitch = 35.F;
  squat.trunk.flexion = 40.F;
  EXPECT_EQ(posture_of(squat), Posture::standing) << "a squat needs no seat";
  BodyAngles one_leg;
  one_leg.legs[0] = {.flexion = 90.F, .knee = 90.F};
  EXPECT_EQ(posture_of(one_leg), Posture::standing);
}

TEST(ClassifyPosture, FindsSittingPeopleByFeetThatCarryNoWeight) {
  EXPECT_EQ(posture_of(legs(90.F, 90.F)), Posture::sitting) << "on a chair";
  EXPECT_EQ(posture_of(legs(90.F, 10.F)), Posture::sitting) << "on the floor, legs stretched";
  BodyAngles sofa = legs(75.F, 60.F);
  sofa.pitch = -30.F;
  EXPECT_EQ(posture_of(sofa), Posture::sitting);
}

TEST(ClassifyPosture, FindsPeopleWhoLieOnBackFrontAndSides) {
  for (const float pitch : {-90.F, 90.F}) {
    BodyAngles angles;
    angles.pitch = pitch;
    EXPECT_EQ(posture_of(angles), Posture::lying);
  }
  BodyAngles side = legs(70.F, 90.F);
  side.roll = -90.F;
  EXPECT_EQ(posture_of(side), Posture::lying);
}

TEST(ClassifyPosture, FindsPeopleWhoKneelOnOneOrTwoKneesOrAllFours) {
  EXPECT_EQ(posture_of(legs(0.F, 102.F, -50.F)), Posture::kneeling);
  BodyAngles one = legs(0.F, 102.F, -50.F);
  one.legs[0] = {.flexion = 90.F, .knee = 90.F};
  EXPECT_EQ(posture_of(one), Posture::kneeling);
  BodyAngles fours = legs(85.F, 107.F, -50.F);
  fours.pitch = 75.F;
  for (ArmAngles& arm : fours.arms) arm = {.elevation = 80.F, .plane = 90.F, .wrist = -70.F};
  EXPECT_EQ(posture_of(fours), Posture::kneeling);
}

TEST(ClassifyPosture, GivesTheSameInAMirror) {
  BodyAngles angles = legs(0.F, 102.F, -50.F);
  angles.legs[1] = {.flexion = 90.F, .knee = 90.F};
  EXPECT_EQ(classify_posture(mirrored(pose_of(angles))), posture_of(angles));
}

using Eigen::Vector3f;

Pose with_hand_at(const Vector3f& offset_from_shoulder) {
  Pose pose = pose_of({});
  const Vector3f shoulder = stick_figure(pose).head_of(Bone::l_upper_arm);
  reach(pose, true, shoulder + offset_from_shoulder, {1.F, -1.F, 0.F});
  return pose;
}

TEST(SelfContact, FindsNothingInPlainPoses) {
  EXPECT_LT(self_overlap_m(Pose()), 0.F) << "a T";
  EXPECT_FALSE(intersects_itself(pose_of({}))) << "arms hang";
  BodyAngles sits;
  for (LegAngles& leg : sits.legs) leg = {.flexion = 95.F, .knee = 100.F};
  EXPECT_FALSE(intersects_itself(pose_of(sits)));
  BodyAngles bent_arms;
  for (ArmAngles& arm : bent_arms.arms) arm = {.elevation = 20.F, .elbow = 150.F};
  EXPECT_FALSE(intersects_itself(pose_of(bent_arms))) << "a forearm folds onto its upper arm";
}

TEST(SelfContact, FindsHandsInTheBody) {
  EXPECT_TRUE(intersects_itself(with_hand_at({-0.22F, -0.25F, 0.F}))) << "in the chest";
  EXPECT_TRUE(intersects_itself(with_hand_at({-0.22F, 0.25F, 0.02F}))) << "in the head";
  EXPECT_FALSE(intersects_itself(with_hand_at({-0.22F, -0.25F, 0.25F}))) << "in front of it";
}

TEST(SelfContact, FindsLegsInEachOther) {
  BodyAngles angles;
  for (LegAngles& leg : angles.legs) leg.abduction = -15.F;
  EXPECT_TRUE(intersects_itself(pose_of(angles)));
  angles.legs[0].abduction = angles.legs[1].abduction = 5.F;
  EXPECT_FALSE(intersects_itself(pose_of(angles)));
  angles.legs[0] = {.flexion = 140.F, .knee = 20.F};
  EXPECT_TRUE(intersects_itself(pose_of(angles))) << "thigh or shin in trunk or head";
}

TEST(SelfContact, GrowsWithDepthAndIsTheSameInAMirror) {
  float before = -1.F;
  for (const float z : {0.20F, 0.16F, 0.12F}) {
    const Pose pose = with_hand_at({-0.2F, -0.3F, z});
    const float overlap = self_overlap_m(pose);
    EXPECT_GT(overlap, before) << z;
    EXPECT_NEAR(self_overlap_m(mirrored(pose)), overlap, 1e-5F);
    before = overlap;
  }
}

TEST(SelfContact, AllowsADeeperTouchOnlyWherePeoplePressLimbsTogether) {
  const Pose on_chest = with_hand_at({-0.2F, -0.3F, 0.10F});
  const float overlap = self_overlap_m(on_chest);
  ASSERT_GT(overlap, kTouch_m);
  EXPECT_TRUE(intersects_itself(on_chest));
  EXPECT_TRUE(intersects_itself(on_chest, overlap - 0.002F));
  EXPECT_FALSE(intersects_itself(on_chest, overlap + 0.002F));
  BodyAngles shins;
  for (LegAngles& leg : shins.legs) leg = {.flexion = 90.F, .external = 30.F, .knee = 100.F};
  ASSERT_TRUE(intersects_itself(pose_of(shins)));
  EXPECT_TRUE(intersects_itself(pose_of(shins), 0.1F)) << "shins are hard";
}

}  // namespace

}  // namespace vesalius::synth
