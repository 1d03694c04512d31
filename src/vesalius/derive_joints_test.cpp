#include "vesalius/derive_joints.h"

#include <gmock/gmock.h>

#include <cmath>

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

TEST(PredictMissingParts, PutsAnElbowBetweenArmAndForearm) {
  Skeleton s = whole_skeleton();
  part_of(s, "l_upper_arm").centre = {0.F, 0.F, 2.F};
  part_of(s, "l_forearm").centre = {0.F, 0.25F, 2.F};
  part_of(s, "l_forearm").confidence = 0.4F;
  part_of(s, "l_elbow") = {};
  predict_missing_parts(paper_body(), s);
  const SkeletonPart& elbow = part_of(s, "l_elbow");
  EXPECT_EQ(elbow.state, State::predicted);
  EXPECT_NEAR(elbow.centre.y(), 0.25F * 0.12F / 0.23F, 1e-5);  // links of 0.12 and 0.11 m
  EXPECT_FLOAT_EQ(elbow.confidence, 0.2F);
}

TEST(PredictMissingParts, PredictsNoEndsOfLimbs) {
  Skeleton s = whole_skeleton();
  part_of(s, "l_hand") = {};
  part_of(s, "r_elbow") = {};
  part_of(s, "r_forearm") = {};  // the elbow's neighbour is missing too
  predict_missing_parts(paper_body(), s);
  EXPECT_EQ(part_of(s, "l_hand").state, State::none);
  EXPECT_EQ(part_of(s, "r_elbow").state, State::none);
}

TEST(DeriveJoints, MovesTheSurfaceIntoTheBody) {
  Skeleton s = whole_skeleton();
  part_of(s, "neck").centre = {0.F, 0.F, 2.F};
  const Joint neck = joint_of(derive_joints(paper_body(), s), "nite15", "neck");
  EXPECT_EQ(neck.state, State::observed);
  EXPECT_NEAR(neck.position.z(), 2.05F, 1e-5);
  EXPECT_FLOAT_EQ(neck.confidence, 0.8F);
}

TEST(DeriveJoints, OmitsAJointWithoutItsParts) {
  Skeleton s = whole_skeleton();
  part_of(s, "l_knee") = {};
  const auto sets = derive_joints(paper_body(), s);
  const Joint& knee = joint_of(sets, "nite15", "l_knee");
  EXPECT_EQ(knee.state, State::none);
  EXPECT_TRUE(std::isnan(knee.position.x()));
  EXPECT_EQ(joint_of(sets, "coco17", "l_ear").state, State::none);  // these parts have no ears
  EXPECT_EQ(joint_of(sets, "nite15", "r_knee").state, State::observed);
}

TEST(DeriveJoints, AcceptsHalfOfTheWeightAndMarksTheJoint) {
  Skeleton s = whole_skeleton();
  part_of(s, "l_chest") = {};  // 0.3 of a shoulder
  const auto sets = derive_joints(paper_body(), s);
  const Joint& shoulder = joint_of(sets, "nite15", "l_shoulder");
  EXPECT_EQ(shoulder.state, State::predicted);
  EXPECT_NEAR(shoulder.position.x(), part_of(s, "l_upper_arm").centre.x(), 0.05F);
}

}  // namespace
}  // namespace vesalius
