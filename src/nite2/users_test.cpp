#include "nite2/users.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "vesalius/body_model.h"
#include "vesalius/fit/flesh_model.h"

namespace vesalius::nite2 {
namespace {

constexpr float kRightAngle = float(std::numbers::pi) / 2.F;

/// Somebody whose bones are all turned from a T before the camera, in the optical frame.
TrackedPerson person_in_tee(const Eigen::Quaternionf& turn = Eigen::Quaternionf::Identity()) {
  TrackedPerson person;
  person.body.emplace();
  FittedBone bone;
  bone.state = State::observed;
  // At rest x is the person's left, y up, z the front: right, up and towards the camera for who faces it.
  Eigen::Matrix3f facing;
  facing.col(0) = Eigen::Vector3f(1.F, 0.F, 0.F);
  facing.col(1) = Eigen::Vector3f(0.F, -1.F, 0.F);
  facing.col(2) = Eigen::Vector3f(0.F, 0.F, -1.F);
  bone.global = turn * Eigen::Quaternionf(facing);
  person.body->bones.assign(builtin_flesh().bones.size(), bone);
  return person;
}

NiteSkeleton skeleton_turned(const Eigen::Quaternionf& turn, bool is_mirrored) {
  const NiteJoints set(paper_body());
  Joints joints;
  joints.fill({State::observed, {0.5F, 0.25F, 2.F}, 0.75F});
  DepthView view{640, 480, 1.F, 0.8F, is_mirrored};
  return skeleton_of(person_in_tee(turn), joints, set, view);
}

TEST(SkeletonOf, HasNoTurnInATBeforeTheCamera) {
  for (const bool is_mirrored : {false, true}) {
    for (const NiteSkeletonJoint& joint : skeleton_turned(Eigen::Quaternionf::Identity(), is_mirrored).joints) {
      EXPECT_NEAR(std::abs(joint.orientation.w), 1.F, 1e-6F) << joint.jointType;
      EXPECT_EQ(joint.orientationConfidence, 0.75F);
      EXPECT_EQ(joint.position.x, is_mirrored ? -500.F : 500.F);
      EXPECT_EQ(joint.position.y, -250.F);
      EXPECT_EQ(joint.position.z, 2000.F);
    }
  }
}

/// As matrices say it: whatever the bone does to an axis of the world, the joint does in the axes of the interface.
TEST(SkeletonOf, TurnsAsTheBoneDoesInTheInterfacesAxes) {
  const Eigen::Quaternionf turn = Eigen::AngleAxisf(0.7F, Eigen::Vector3f::UnitX()) *
                                  Eigen::AngleAxisf(-1.1F, Eigen::Vector3f::UnitY()) *
                                  Eigen::AngleAxisf(0.4F, Eigen::Vector3f::UnitZ());
  for (const bool is_mirrored : {false, true}) {
    const Eigen::Matrix3f axes = Eigen::Vector3f(is_mirrored ? -1.F : 1.F, -1.F, 1.F).asDiagonal();
    const NiteQuaternion q = skeleton_turned(turn, is_mirrored).joints[NITE_JOINT_LEFT_ELBOW].orientation;
    const Eigen::Matrix3f told = Eigen::Quaternionf(q.w, q.x, q.y, q.z).toRotationMatrix();
    EXPECT_LT((told - axes * turn.toRotationMatrix() * axes).norm(), 1e-5F);
  }
  // Who turns by a quarter to the own left has the left arm, x of the picture, pointing away from the camera.
  const Eigen::Quaternionf left(Eigen::AngleAxisf(-kRightAngle, Eigen::Vector3f::UnitY()));
  const NiteQuaternion q = skeleton_turned(left, false).joints[NITE_JOINT_TORSO].orientation;
  const Eigen::Vector3f arm = Eigen::Quaternionf(q.w, q.x, q.y, q.z) * Eigen::Vector3f::UnitX();
  EXPECT_NEAR(arm.z(), 1.F, 1e-5F);
}

TEST(SkeletonOf, GivesWhatNobodyKnowsThePlaceOfTheNextJoint) {
  const NiteJoints set(paper_body());
  Joints joints;
  joints.fill({State::none, Eigen::Vector3f::Constant(NAN), 0.F});
  joints[NITE_JOINT_LEFT_ELBOW] = {State::observed, {1.F, 0.F, 2.F}, 0.6F};
  TrackedPerson person;
  person.position = {0.F, 0.F, 3.F};
  const NiteSkeleton skeleton = skeleton_of(person, joints, set, {640, 480, 1.F, 0.8F, false});
  EXPECT_EQ(skeleton.joints[NITE_JOINT_RIGHT_FOOT].position.z, 3000.F);
  EXPECT_EQ(skeleton.joints[NITE_JOINT_RIGHT_FOOT].positionConfidence, 0.F);
  EXPECT_EQ(skeleton.joints[NITE_JOINT_LEFT_HAND].position.x, 1000.F);
  EXPECT_EQ(skeleton.joints[NITE_JOINT_LEFT_HAND].positionConfidence, 0.F);
  EXPECT_EQ(skeleton.joints[NITE_JOINT_LEFT_HAND].orientationConfidence, 0.F);
  EXPECT_EQ(skeleton.joints[NITE_JOINT_LEFT_HAND].orientation.w, 1.F);
}

TEST(UserId, StaysWithinTheInterfaces) {
  EXPECT_EQ(user_id(1), 1);
  EXPECT_EQ(user_id(32767), 32767);
  EXPECT_EQ(user_id(32768), 1);
  EXPECT_EQ(user_id(2'000'000'000) > 0, true);
}

}  // namespace
}  // namespace vesalius::nite2
