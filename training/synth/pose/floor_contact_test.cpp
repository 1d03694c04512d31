#include "synth/pose/floor_contact.h"

#include <gtest/gtest.h>

#include "synth/pose/joint_angles.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

Pose stiff(float pitch, float roll = 0.F) {
  BodyAngles angles;
  angles.pitch = pitch;
  angles.roll = roll;
  return pose_of(angles);
}

TEST(FloorContact, FindsTheSkinThatIsLowest) {
  const Pose upright = stiff(0.F);
  const float ankle = stick_figure(upright).head_of(Bone::l_foot).y();
  EXPECT_NEAR(floor_y(upright), ankle - kFlatAnkle_m, 0.01F);
  EXPECT_NEAR(skin_height_m(upright, Bone::l_foot).value(), 0.F, 1e-4F);
  EXPECT_GT(skin_height_m(upright, Bone::head).value(), 1.3F);
  EXPECT_FALSE(skin_height_m(upright, Bone::l_clavicle).has_value());
}

TEST(Settle, LeavesWhoStandsAndTipsWhoLeans) {
  Pose upright = stiff(1.F);
  EXPECT_LT(settle(upright), 3.F);
  Pose leaning = stiff(15.F);
  EXPECT_GT(out_of_support_m(leaning), 0.02F);
  EXPECT_GT(settle(leaning), 10.F);
}

TEST(Settle, PutsTheWeightOverWhatCarriesIt) {
  for (const float pitch : {-95.F, -80.F, 80.F, 100.F}) {
    Pose lying = stiff(pitch);
    settle(lying);
    int low = 0;
    for (int b = 0; b < kBoneCount; ++b) {
      const std::optional<float> height = skin_height_m(lying, static_cast<Bone>(b));
      low += height && *height < 0.005F ? 1 : 0;
    }
    EXPECT_GE(low, 2) << pitch;
    EXPECT_LT(out_of_support_m(lying), 0.F) << pitch;
    EXPECT_LT(settle(lying), 0.5F) << "rests already";
  }
}

TEST(SettleLengthwise, DoesNotRoll) {
  Pose side = stiff(0.F, 70.F);
  settle_lengthwise(side);
  const Vector3f front = world_rotations(side)[0] * Vector3f::UnitZ();
  EXPECT_NEAR(front.y(), 0.F, 0.05F) << "still on the side";
}

TEST(PlantHand, PutsAFlatHandOnAPoint) {
  BodyAngles angles;
  angles.pitch = 80.F;
  for (LegAngles& leg : angles.legs) leg = {.flexion = 80.F, .knee = 102.F, .ankle = -50.F};
  Pose pose = pose_of(angles);
  const Vector3f shoulder = stick_figure(pose).head_of(Bone::l_upper_arm);
  const Vector3f at(shoulder.x(), floor_y(pose, false), shoulder.z());
  ASSERT_TRUE(plant_hand(pose, true, at, Vector3f::UnitZ()));
  EXPECT_LT((stick_figure(pose).head_of(Bone::l_hand) - at).norm(), kFlatWrist_m + 0.005F);
  EXPECT_TRUE(arm_in_range(arm_angles(pose, true)));
  EXPECT_LT(skin_height_m(pose, Bone::l_hand).value(), 0.02F);
  EXPECT_FALSE(plant_hand(pose, true, at + Vector3f(0.F, 0.F, 0.6F), Vector3f::UnitZ())) << "out of reach";
}

TEST(PlantForearm, PutsElbowAndHandOnTheFloor) {
  for (const bool left : {true, false}) {
    Pose pose = stiff(0.F);
    const float shoulder = stick_figure(pose).head_of(Bone::l_upper_arm).y(), floor = shoulder - 0.3F;
    ASSERT_TRUE(plant_forearm(pose, left, floor, Vector3f::UnitZ(), Vector3f::UnitZ()));
    const StickFigure figure = stick_figure(pose);
    EXPECT_NEAR(figure.head_of(left ? Bone::l_forearm : Bone::r_forearm).y(), floor + kRestingElbow_m, 1e-3F);
    EXPECT_NEAR(figure.head_of(left ? Bone::l_hand : Bone::r_hand).y(), floor + kRestingElbow_m, 1e-3F);
    EXPECT_FALSE(plant_forearm(pose, left, shoulder - 0.5F, Vector3f::UnitZ(), Vector3f::UnitZ())) << "too high";
  }
}

TEST(FacingAs, LeavesOnlyTheTurnThatIsNoYaw) {
  const Pose back = stiff(-90.F), side = stiff(0.F, 90.F);
  const Pose turned = facing_as(side, back);
  EXPECT_NEAR(turned[Bone::pelvis].angularDistance(back[Bone::pelvis]), 1.5708F, 1e-3F) << "a quarter about the body";
  EXPECT_LT(without_yaw(turned[Bone::pelvis]).angularDistance(without_yaw(side[Bone::pelvis])), 1e-3F);
}

}  // namespace
}  // namespace vesalius::synth
