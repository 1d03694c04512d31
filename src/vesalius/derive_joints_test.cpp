#include "vesalius/derive_joints.h"

#include <gmock/gmock.h>

#include <cmath>

#include "vesalius/base/body_heading.h"

namespace vesalius {
namespace {

Skeleton whole_skeleton() {
  Skeleton s;
  for (int i = 0; i < paper_body().part_count(); ++i) {
    SkeletonPart part;
    part.state = State::observed;
    part.centre = Eigen::Vector3f(0.1F * static_cast<float>(i), 0.F, 2.F);
    part.confidence = 0.8F;
    s.parts.push_back(part);
  }
  return s;
}

SkeletonPart& part_of(Skeleton& s, const char* name) { return s.parts[paper_body().find_part(name)]; }

const Joint& joint_of(const std::vector<std::vector<Joint>>& sets, const char* set, const char* name) {
  const BodyModel& body = paper_body();
  for (std::size_t i = 0; i < body.joint_sets.size(); ++i) {
    if (body.joint_sets[i].name != set) continue;
    for (std::size_t j = 0; j < body.joint_sets[i].joints.size(); ++j) {
      if (body.joint_sets[i].joints[j].name == name) return sets[i][j];
    }
  }
  ADD_FAILURE() << set << ' ' << name;
  return sets[0][0];
}

const Eigen::Vector3f kUp(0.F, -1.F, 0.F);

/// Returns a joint made of two parts of the left arm.
JointDefinition elbow() {
  return {"elbow", {paper_body().find_part("l_elbow"), paper_body().find_part("l_forearm")}, {0.6F, 0.4F}, 0.04F, 0.1F};
}

TEST(DeriveJoints, MovesTheSurfaceIntoTheBodyAndAlongIt) {
  Skeleton s = whole_skeleton();
  part_of(s, "l_elbow").centre = part_of(s, "l_forearm").centre = {0.F, 0.F, 2.F};
  const Joint joint = derive_joint(elbow(), s, Eigen::Vector3f(1.F, 0.F, 0.F));  // somebody who lies
  EXPECT_EQ(joint.state, State::observed);
  EXPECT_LT((joint.position - Eigen::Vector3f(0.1F, 0.F, 2.04F)).norm(), 1e-5F);
  EXPECT_FLOAT_EQ(joint.confidence, 0.8F);
}

TEST(DeriveJoints, KeepsTheOffsetsWhereAPartIsMissing) {
  Skeleton s = whole_skeleton();
  part_of(s, "l_elbow").centre = {0.F, 0.F, 2.F};
  part_of(s, "l_forearm") = {};
  const Joint joint = derive_joint(elbow(), s, kUp);
  EXPECT_EQ(joint.state, State::predicted);
  EXPECT_LT((joint.position - Eigen::Vector3f(0.F, -0.1F, 2.04F)).norm(), 1e-5F);
  EXPECT_FLOAT_EQ(joint.confidence, 0.6F * 0.8F);
}

TEST(DeriveJoints, TakesTheBodysAxisFromTheParts) {
  Skeleton s = whole_skeleton();
  for (int i = 0; i < paper_body().part_count(); ++i) {
    s.parts[i].centre = {paper_body().parts[i].upper_body ? 0.5F : -0.5F, 0.F, 2.F};
  }
  const Eigen::Vector3f up = body_up(given_centres(s), paper_body());
  EXPECT_LT((up - Eigen::Vector3f(1.F, 0.F, 0.F)).norm(), 1e-5F);
  BodyModel body = paper_body();
  body.joint_sets = {{"one", {elbow()}}};
  EXPECT_LT((derive_joints(body, s)[0][0].position - derive_joint(elbow(), s, up).position).norm(), 1e-6F);
}

TEST(DeriveJoints, FollowsVotesForPartsThatAreSeen) {
  BodyModel body = paper_body();
  Skeleton s = whole_skeleton();
  for (const SkeletonPart& part : s.parts) s.voted.push_back({part.centre, 0.F});
  const int chest = body.find_part("l_chest");
  s.voted[chest].centre.y() += 1.F;
  const auto shoulder = [&] { return joint_of(derive_joints(body, s), "coco17", "l_shoulder").position.y(); };
  const float drawn = shoulder();
  body.distribution.parts[chest].observed_m = 0.F;
  EXPECT_GT(drawn, shoulder() + 0.05F);
}

TEST(DeriveJoints, HasNoJointThatTheBodyLacks) {
  const auto sets = derive_joints(paper_body(), whole_skeleton());
  EXPECT_EQ(joint_of(sets, "coco17", "l_ear").state, State::none);  // these parts have no ears
  EXPECT_EQ(joint_of(sets, "coco17", "r_knee").state, State::observed);
}

TEST(DeriveJoints, LiesBeyondAPartWithANegativeWeightForAnother) {
  const JointDefinition wrist{
      "wrist", {paper_body().find_part("l_forearm"), paper_body().find_part("l_elbow")}, {1.5F, -0.5F}, 0.F, 0.F};
  Skeleton s = whole_skeleton();
  part_of(s, "l_elbow").centre = {0.F, 0.F, 2.F};
  part_of(s, "l_forearm").centre = {0.2F, 0.F, 2.F};
  const Joint whole = derive_joint(wrist, s, kUp);
  EXPECT_LT((whole.position - Eigen::Vector3f(0.3F, 0.F, 2.F)).norm(), 1e-5F);
  EXPECT_FLOAT_EQ(whole.confidence, 0.8F);
  part_of(s, "l_elbow") = {};
  const Joint half = derive_joint(wrist, s, kUp);
  EXPECT_LT((half.position - Eigen::Vector3f(0.2F, 0.F, 2.F)).norm(), 1e-5F);
  EXPECT_LT(half.confidence, whole.confidence);
}

TEST(DeriveJoints, NeedsHalfOfTheWeight) {
  Skeleton s = whole_skeleton();
  part_of(s, "l_elbow") = {};  // 0.6 of the joint
  const Joint joint = derive_joint(elbow(), s, kUp);
  EXPECT_EQ(joint.state, State::none);
  EXPECT_TRUE(joint.position.hasNaN());
}

}  // namespace
}  // namespace vesalius
