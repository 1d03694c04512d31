#include "ros2/messages/human_frames.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "ros2/messages/test_people.h"

namespace vesalius::ros2 {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

class HumanFrames : public testing::Test {
 protected:
  static void place(TrackedPerson& person, const std::string& name, const Vector3f& at) {
    const BodyModel& body = paper_body();
    for (std::size_t set = 0; set < body.joint_sets.size(); ++set) {
      person.person.joints.resize(body.joint_sets.size());
      person.person.joints[set].resize(body.joint_sets[set].joints.size());
      for (std::size_t j = 0; j < body.joint_sets[set].joints.size(); ++j) {
        if (body.joint_sets[set].joints[j].name == name) person.person.joints[set][j] = {State::observed, at, 1.F};
      }
    }
  }
  /// Somebody upright who faces the camera: their left is at the right of the picture.
  static TrackedPerson standing() {
    TrackedPerson person;
    person.id = 1;
    const Vector3f waist(0.F, 0.F, 3.F);
    place(person, "pelvis", waist);
    for (const float side : {1.F, -1.F}) {
      const std::string l = side > 0 ? "l_" : "r_";
      place(person, l + "shoulder", waist + Vector3f(0.2F * side, -0.5F, 0.F));
      place(person, l + "elbow", waist + Vector3f(0.2F * side, -0.2F, 0.F));
      place(person, l + "wrist", waist + Vector3f(0.2F * side, 0.05F, 0.F));
      place(person, l + "hip", waist + Vector3f(0.1F * side, 0.05F, 0.F));
      place(person, l + "knee", waist + Vector3f(0.1F * side, 0.5F, 0.F));
      place(person, l + "ankle", waist + Vector3f(0.1F * side, 0.9F, 0.F));
    }
    place(person, "head", waist + Vector3f(0.F, -0.75F, 0.F));
    return person;
  }
  static std::vector<FrameTransform> frames(const TrackedPerson& person) {
    return human_frames(person, NamedJoints(paper_body()), "p1", "camera", {0.F, -1.F, 0.F});
  }
  static Eigen::Isometry3d frame(const std::vector<FrameTransform>& all, const std::string& name) {
    const auto found = std::ranges::find(all, name, &FrameTransform::child);
    EXPECT_NE(found, all.end()) << name;
    return found == all.end() ? Eigen::Isometry3d::Identity() : found->parent_from_child;
  }
};

TEST_F(HumanFrames, HaveTheNamesOfHumanDescription) {
  std::vector<std::string> names;
  for (const FrameTransform& one : frames(standing())) {
    names.push_back(one.child);
    EXPECT_EQ(one.parent, one.child == "body_p1" ? "camera" : "body_p1");
  }
  EXPECT_THAT(names, testing::ElementsAre("body_p1", "waist_p1", "torso_p1", "head_p1", "l_shoulder_p1", "l_elbow_p1",
                                          "l_wrist_p1", "r_shoulder_p1", "r_elbow_p1", "r_wrist_p1", "l_hip_p1",
                                          "l_knee_p1", "l_ankle_p1", "r_hip_p1", "r_knee_p1", "r_ankle_p1"));
}

TEST_F(HumanFrames, BodyLooksForwardWithLeftAtItsLeft) {
  const auto all = frames(standing());
  const Eigen::Isometry3d body = frame(all, "body_p1");
  EXPECT_TRUE(body.translation().isApprox(Vector3d(0, 0, 3), 1e-6));
  EXPECT_TRUE(body.linear().col(0).isApprox(Vector3d(0, 0, -1), 1e-6)) << "forward is towards the camera";
  EXPECT_TRUE(body.linear().col(1).isApprox(Vector3d(1, 0, 0), 1e-6));
  EXPECT_TRUE(body.linear().col(2).isApprox(Vector3d(0, -1, 0), 1e-6));
  // In the body's own axes: x forward, y left, z up.
  EXPECT_TRUE(frame(all, "torso_p1").translation().isApprox(Vector3d(0, 0, 0.5), 1e-6));
  EXPECT_TRUE(frame(all, "l_shoulder_p1").translation().isApprox(Vector3d(0, 0.2, 0.5), 1e-6));
  EXPECT_TRUE(frame(all, "r_ankle_p1").translation().isApprox(Vector3d(0, -0.1, -0.9), 1e-6));
}

TEST_F(HumanFrames, OfHangingLimbsAreThoseOfTheBody) {
  for (const FrameTransform& one : frames(standing())) {
    if (one.child == "body_p1") continue;
    EXPECT_TRUE(one.parent_from_child.linear().isApprox(Eigen::Matrix3d::Identity(), 1e-6)) << one.child;
  }
}

TEST_F(HumanFrames, ElbowsAndKneesTurnAboutY) {
  TrackedPerson person = standing();
  place(person, "l_wrist", Vector3f(0.2F, -0.2F, 2.75F));  // the forearm points forward
  place(person, "r_ankle", Vector3f(-0.1F, 0.5F, 3.4F));   // the lower leg points back
  const auto all = frames(person);
  // human_description: the elbow turns about -y from 0 up, the knee about -y from 0 down.
  const Eigen::Matrix3d elbow = frame(all, "l_shoulder_p1").linear().transpose() * frame(all, "l_elbow_p1").linear();
  const Eigen::Matrix3d knee = frame(all, "r_hip_p1").linear().transpose() * frame(all, "r_knee_p1").linear();
  const double right_angle = std::acos(0.0);
  EXPECT_TRUE(elbow.isApprox(Eigen::AngleAxisd(right_angle, -Vector3d::UnitY()).toRotationMatrix(), 1e-5)) << elbow;
  EXPECT_TRUE(knee.isApprox(Eigen::AngleAxisd(-right_angle, -Vector3d::UnitY()).toRotationMatrix(), 1e-5)) << knee;
  // A limb hangs along -z.
  EXPECT_TRUE(
      (frame(all, "l_elbow_p1") * Vector3d(0, 0, -0.25)).isApprox(frame(all, "l_wrist_p1").translation(), 1e-5));
}

TEST_F(HumanFrames, OfSomebodyOfWhomLittleIsKnownFacesTheCamera) {
  TrackedPerson person;
  person.id = 1;
  person.position = {1.F, 0.F, 1.F};
  const auto all = frames(person);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_TRUE(all[0].parent_from_child.translation().isApprox(Vector3d(1, 0, 1), 1e-6));
  EXPECT_TRUE(all[0].parent_from_child.linear().col(0).isApprox(Vector3d(-1, 0, -1).normalized(), 1e-6));
  EXPECT_TRUE(all[0].parent_from_child.linear().col(2).isApprox(Vector3d(0, -1, 0), 1e-6));
}

TEST_F(HumanFrames, AreRotationsWhateverThePose) {
  TrackedPerson person = standing();
  place(person, "l_elbow", Vector3f(0.5F, -0.5F, 3.F));  // the arm is stretched to the side
  place(person, "l_wrist", Vector3f(0.8F, -0.5F, 3.F));
  place(person, "r_elbow", Vector3f(-0.2F, -0.5F, 2.7F));  // and to the front
  place(person, "r_wrist", Vector3f(-0.2F, -0.5F, 2.4F));
  place(person, "r_knee", Vector3f(-0.1F, 0.05F, 3.F));  // two joints in one place
  for (const FrameTransform& one : frames(person)) {
    EXPECT_TRUE(one.parent_from_child.linear().isUnitary(1e-6)) << one.child;
    EXPECT_NEAR(one.parent_from_child.linear().determinant(), 1.0, 1e-6) << one.child;
    EXPECT_TRUE(one.parent_from_child.matrix().allFinite()) << one.child;
  }
}

}  // namespace
}  // namespace vesalius::ros2
