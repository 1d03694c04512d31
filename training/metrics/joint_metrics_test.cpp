#include "metrics/joint_metrics.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "metrics/test_terms.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using test::value_of;

using Eigen::Vector3f;

const Vector3f kNothing = Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
const std::vector<std::string> kNames{"head", "l_hip", "r_hip", "l_hand"};

/// Returns joints with the head 5 cm too deep, one hip 20 cm aside, the other hip right, and no hand.
JointPair by_hand() {
  return {{{0, -1, 2}, {0.2F, 0, 2}, {-0.2F, 0, 2}, {0.5F, 0, 2}},
          {{0, -1, 2.05F}, {0.4F, 0, 2}, {-0.2F, 0, 2}, kNothing}};
}

TEST(JointMetrics, AgreeWithCountingByHand) {
  const MetricTerms terms = joint_terms(by_hand(), kNames);
  EXPECT_DOUBLE_EQ(value_of(terms, "joints.at_10cm"), 0.5);
  EXPECT_DOUBLE_EQ(value_of(terms, "joint.head.at_10cm"), 1.0);
  EXPECT_DOUBLE_EQ(value_of(terms, "joint.l_hip.at_10cm"), 0.0);
  EXPECT_DOUBLE_EQ(value_of(terms, "joint.l_hand.at_10cm"), 0.0);
  EXPECT_TRUE(std::isnan(value_of(terms, "joint.l_hand.error_m")));
  EXPECT_NEAR(value_of(terms, "joint.head.error_m"), 0.05, 1e-6);
  EXPECT_NEAR(value_of(terms, "joints.error_m"), 0.25 / 3, 1e-6);
}

TEST(JointMetrics, IgnoreUnknownTruth) {
  JointPair pair = by_hand();
  pair.truth[3] = kNothing;
  const MetricTerms terms = joint_terms(pair, kNames);
  EXPECT_DOUBLE_EQ(value_of(terms, "joints.at_10cm"), 2.0 / 3.0);
  EXPECT_TRUE(std::isnan(value_of(terms, "joint.l_hand.at_10cm")));
}

TEST(JointMetrics, CountAllJointsOfAMissedPersonAsWrong) {
  JointPair pair = by_hand();
  std::ranges::fill(pair.found, kNothing);
  const MetricTerms terms = joint_terms(pair, kNames);
  EXPECT_DOUBLE_EQ(value_of(terms, "joints.at_10cm"), 0.0);
  EXPECT_TRUE(std::isnan(value_of(terms, "joints.error_m")));
  EXPECT_EQ(terms.size(), 5U);
}

TEST(CentreMetrics, AreThoseOfJointsUnderOtherNames) {
  const MetricTerms terms = centre_terms(by_hand(), kNames);
  EXPECT_DOUBLE_EQ(value_of(terms, "centres.at_10cm"), 0.5);
  EXPECT_DOUBLE_EQ(value_of(terms, "centre.head.at_10cm"), 1.0);
  EXPECT_TRUE(std::isnan(value_of(terms, "joints.at_10cm")));
}

TEST(JointBias, IsMeasuredAlongTheTrueBody) {
  const std::vector<std::string> names{"neck", "l_shoulder", "r_shoulder", "l_hip", "r_hip", "l_hand"};
  // A person on the side: the head is at the picture's right, the own left side is below.
  JointPair pair{{{0.6F, 0, 2}, {0.5F, 0.2F, 2}, {0.5F, -0.2F, 2}, {0, 0.1F, 2}, {0, -0.1F, 2}, {0, 0, 2}}, {}};
  pair.found = pair.truth;
  pair.found[0].x() -= 0.03F;  // towards the hips
  pair.found[5] += Vector3f(0.F, 0.02F, 0.05F);
  const MetricTerms terms = joint_bias_terms(pair, names);
  EXPECT_NEAR(value_of(terms, "joint.neck.up_mm"), -30.0, 1e-3);
  EXPECT_NEAR(value_of(terms, "joint.neck.placed_up_mm"), -30.0, 1e-3);
  EXPECT_NEAR(value_of(terms, "joint.l_hip.up_mm"), 0.0, 1e-3);
  EXPECT_NEAR(value_of(terms, "joint.l_hand.up_mm"), 0.0, 1e-3);
}

TEST(JointBias, LeavesOutSwappedJoints) {
  const std::vector<std::string> names{"l_hand", "r_hand", "neck", "hip_center"};
  const std::vector<Vector3f> truth{{0.3F, 0, 2}, {-0.3F, 0, 2}, {0, -0.5F, 2}, {0, 0, 2}};
  const MetricTerms terms = joint_bias_terms({truth, {{-0.25F, 0, 2}, {-0.25F, 0, 2}, truth[2], truth[3]}}, names);
  EXPECT_TRUE(std::isnan(value_of(terms, "joint.l_hand.up_mm")));
  EXPECT_FALSE(std::isnan(value_of(terms, "joint.r_hand.up_mm")));
}

TEST(JointBias, OfPlacedJointsLeavesOutGrossMistakes) {
  const std::vector<std::string> names{"neck", "l_shoulder", "r_shoulder", "l_hip", "r_hip", "l_hand"};
  JointPair pair{{{0, -0.5F, 2}, {0.2F, -0.4F, 2}, {-0.2F, -0.4F, 2}, {0.1F, 0, 2}, {-0.1F, 0, 2}, {0.3F, 0, 2}}, {}};
  pair.found = pair.truth;
  pair.found[0].y() += 0.3F;
  pair.found[5].y() += 0.2F;
  const MetricTerms terms = joint_bias_terms(pair, names);
  EXPECT_NEAR(value_of(terms, "joint.neck.up_mm"), -300.0, 1e-3);
  EXPECT_TRUE(std::isnan(value_of(terms, "joint.neck.placed_up_mm")));
  EXPECT_NEAR(value_of(terms, "joint.l_hand.placed_up_mm"), -200.0, 1e-3);
}

TEST(JointBias, IsNotKnownWithoutHips) {
  EXPECT_TRUE(joint_bias_terms({{{0, 0, 2}, {0, 0.2F, 2}}, {{0, 0, 2.01F}, {0, 0.2F, 2}}}, {"head", "neck"}).empty());
}

TEST(PredictedParts, AreThoseNotObserved) {
  Skeleton skeleton;
  skeleton.parts.resize(4);
  JointPair centres;
  for (std::size_t p = 0; p < 4; ++p) centres.truth.emplace_back(0.F, 0.1F * static_cast<float>(p), 2.F);
  centres.found = centres.truth;
  skeleton.parts[0].state = State::observed;
  skeleton.parts[1].state = skeleton.parts[2].state = State::predicted;
  centres.found[2].x() = 0.2F;
  centres.found[3] = kNothing;
  const MetricTerms terms = predicted_part_terms(skeleton, centres);
  EXPECT_DOUBLE_EQ(value_of(terms, "missing.right"), 1.0 / 3.0);
}

TEST(JointsByName, AreInTheOrderOfTheTruth) {
  const JointSet& set = paper_body().joint_sets.front();  // nite15
  std::vector<Joint> joints(set.joints.size());
  for (std::size_t j = 0; j < joints.size(); ++j) joints[j] = {State::observed, {static_cast<float>(j), 0, 1}, 1.F};
  joints[1].state = State::none;
  const auto found = joints_by_name({"l_shoulder", "head", "neck"}, set, joints);
  EXPECT_EQ(found[0].x(), 2.F);
  EXPECT_EQ(found[1].x(), 0.F);
  EXPECT_TRUE(found[2].hasNaN());
  EXPECT_TRUE(joints_by_name({"head"}, set, {})[0].hasNaN());
  EXPECT_THROW(joints_by_name({"tail"}, set, joints), Error);
  EXPECT_EQ(joint_set_with_names(paper_body(), {"head", "torso"})->name, "nite15");
  EXPECT_EQ(joint_set_with_names(paper_body(), {"nose"})->name, "k4abt32");
  EXPECT_EQ(joint_set_with_names(paper_body(), {"head"}, "k4abt32")->name, "k4abt32");
  EXPECT_EQ(joint_set_with_names(paper_body(), {"torso"}, "k4abt32")->name, "nite15");  // which has no torso
  EXPECT_EQ(joint_set_with_names(paper_body(), {"tail"}), nullptr);
}

}  // namespace
}  // namespace vesalius
