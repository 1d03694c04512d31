#include "nite2/pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "nite2/users.h"

namespace vesalius::nite2 {
namespace {

const Eigen::Vector3f kUp(0.F, -1.F, 0.F);

/// Somebody two metres before the camera who lets the arms hang, in metres: x right, y down, and so to the own left.
Joints standing() {
  Joints joints;
  joints.fill({State::observed, {0.F, 0.F, 2.F}, 0.9F});
  const auto put = [&](NiteJointType joint, float x, float y) { joints[joint].position = {x, y, 2.F}; };
  put(NITE_JOINT_HEAD, 0.F, -0.6F), put(NITE_JOINT_NECK, 0.F, -0.4F), put(NITE_JOINT_TORSO, 0.F, -0.1F);
  put(NITE_JOINT_LEFT_SHOULDER, 0.18F, -0.35F), put(NITE_JOINT_RIGHT_SHOULDER, -0.18F, -0.35F);
  put(NITE_JOINT_LEFT_ELBOW, 0.2F, -0.05F), put(NITE_JOINT_RIGHT_ELBOW, -0.2F, -0.05F);
  put(NITE_JOINT_LEFT_HAND, 0.2F, 0.2F), put(NITE_JOINT_RIGHT_HAND, -0.2F, 0.2F);
  return joints;
}

Joints psi() {
  Joints joints = standing();
  joints[NITE_JOINT_LEFT_ELBOW].position = {0.46F, -0.33F, 2.F};
  joints[NITE_JOINT_LEFT_HAND].position = {0.47F, -0.6F, 1.95F};
  joints[NITE_JOINT_RIGHT_ELBOW].position = {-0.46F, -0.33F, 2.F};
  joints[NITE_JOINT_RIGHT_HAND].position = {-0.47F, -0.6F, 1.95F};
  return joints;
}

Joints crossed() {
  Joints joints = standing();
  joints[NITE_JOINT_LEFT_HAND].position = {-0.1F, -0.2F, 1.7F};
  joints[NITE_JOINT_RIGHT_HAND].position = {0.1F, -0.22F, 1.7F};
  return joints;
}

Joints turned(Joints joints, float yaw_rad) {
  const Eigen::AngleAxisf by(yaw_rad, Eigen::Vector3f::UnitY());
  for (Joint& joint : joints) joint.position = by * joint.position;
  return joints;
}

TEST(HoldsPose, KnowsPsiAndCrossedHandsHoweverSomebodyFaces) {
  for (const float yaw_rad : {-0.6F, 0.F, 0.9F}) {
    for (const NitePoseType pose : {NITE_POSE_PSI, NITE_POSE_CROSSED_HANDS}) {
      EXPECT_FALSE(holds_pose(turned(standing(), yaw_rad), pose, kUp));
      EXPECT_EQ(holds_pose(turned(psi(), yaw_rad), pose, kUp), pose == NITE_POSE_PSI);
      EXPECT_EQ(holds_pose(turned(crossed(), yaw_rad), pose, kUp), pose == NITE_POSE_CROSSED_HANDS);
    }
  }
}

TEST(HoldsPose, NeedsBothSides) {
  Joints half = psi();
  half[NITE_JOINT_LEFT_HAND].position = standing()[NITE_JOINT_LEFT_HAND].position;
  EXPECT_FALSE(holds_pose(half, NITE_POSE_PSI, kUp));
  Joints raised = psi();  // both arms straight up
  raised[NITE_JOINT_LEFT_ELBOW].position = {0.2F, -0.62F, 2.F};
  raised[NITE_JOINT_RIGHT_ELBOW].position = {-0.2F, -0.62F, 2.F};
  EXPECT_FALSE(holds_pose(raised, NITE_POSE_PSI, kUp));
}

TEST(HoldsPose, SaysNothingOfJointsThatNobodyKnows) {
  Joints joints = psi();
  joints[NITE_JOINT_LEFT_HAND].confidence = 0.4F;
  EXPECT_FALSE(holds_pose(joints, NITE_POSE_PSI, kUp));
  joints = crossed();
  joints[NITE_JOINT_TORSO].state = State::none;
  EXPECT_FALSE(holds_pose(joints, NITE_POSE_CROSSED_HANDS, kUp));
}

TEST(PoseOf, EntersOnceAndLeavesOnce) {
  bool held = false;
  std::vector<int> states;
  for (const bool holds : {false, true, true, false, false}) {
    states.push_back(pose_of(NITE_POSE_PSI, true, holds, held).state);
  }
  EXPECT_EQ(states, (std::vector<int>{1, 7, 3, 9, 1}));
  pose_of(NITE_POSE_PSI, true, true, held);
  EXPECT_EQ(pose_of(NITE_POSE_PSI, false, true, held).state, NITE_POSE_STATE_EXIT) << "nobody asks any more";
  EXPECT_EQ(pose_of(NITE_POSE_PSI, false, true, held).state, 0);
}

}  // namespace
}  // namespace vesalius::nite2
