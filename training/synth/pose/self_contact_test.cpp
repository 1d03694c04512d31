#include "synth/pose/self_contact.h"

#include <gtest/gtest.h>

#include "synth/pose/joint_angles.h"
#include "synth/pose/stick_figure.h"

namespace vesalius::synth {
namespace {

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

}  // namespace
}  // namespace vesalius::synth
