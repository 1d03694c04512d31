#include "metrics/joint_metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "metrics/test_terms.h"
#include "vesalius/base/random.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using test::value_of;
using testing::ElementsAre;

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

const Vector3f kUnknown = Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
const std::vector<std::string> kHead{"head"};

JointProposals proposal(float score, float x) { return {score, {{x, 0.F, 2.F}}}; }

/// Returns the average precision of the head; NaN if it does not occur.
double average(const JointPrecision& precision) {
  const auto averages = precision.averages();
  return averages.empty() ? std::nan("") : averages.front().second;
}

TEST(JointPrecision, AgreesWithCountingByHand) {
  // The true heads are at 0 and 5. In the order of scores proposals are right, wrong, right, so the precision is 1,
  // 1/2, 2/3 at recall 1/2, 1/2, 1.
  JointPrecision precision;
  precision.add(kHead, {proposal(0.2F, 5.F), proposal(0.9F, 0.05F), proposal(0.5F, 2.F)},
                {{{0.F, 0.F, 2.F}}, {{5.F, 0.F, 2.F}}}, 2);
  EXPECT_DOUBLE_EQ(average(precision), 0.5 * 1.0 + 0.5 * 2.0 / 3.0);
}

TEST(JointPrecision, CountsASecondProposalOfAJointAsWrong) {
  JointPrecision precision;
  const std::vector<std::vector<Vector3f>> truth{{{0.F, 0.F, 2.F}}, {{5.F, 0.F, 2.F}}};
  precision.add(kHead, {proposal(0.9F, 0.F), proposal(0.8F, 0.01F), proposal(0.7F, 5.F)}, truth, 2);
  EXPECT_DOUBLE_EQ(average(precision), 0.5 + 0.5 * 2.0 / 3.0);
}

TEST(JointPrecision, LosesRecallByMissedAndPrecisionByFarJoints) {
  JointPrecision precision;
  precision.add(kHead, {proposal(0.9F, 0.11F)}, {{{0.F, 0.F, 2.F}}}, 1);
  EXPECT_DOUBLE_EQ(average(precision), 0.0);
  precision.add(kHead, {}, {{{0.F, 0.F, 2.F}}}, 1);
  precision.add(kHead, {proposal(0.95F, 0.F)}, {{{0.F, 0.F, 2.F}}}, 1);
  EXPECT_DOUBLE_EQ(average(precision), 1.0 / 3.0);
}

TEST(JointPrecision, IgnoresUncountedPeopleAndUnknownJoints) {
  JointPrecision precision;
  precision.add(kHead, {proposal(0.9F, 0.F), proposal(0.95F, 5.F)}, {{{0.F, 0.F, 2.F}}, {{5.F, 0.F, 2.F}}}, 1);
  EXPECT_DOUBLE_EQ(average(precision), 1.0);
  precision.add(kHead, {proposal(0.99F, 3.F)}, {{kUnknown}}, 1);
  EXPECT_DOUBLE_EQ(average(precision), 1.0);
  precision.add(kHead, {{0.99F, {kUnknown}}}, {{{0.F, 0.F, 2.F}}}, 0);
  EXPECT_DOUBLE_EQ(average(precision), 1.0);
}

TEST(JointPrecision, CountsProposalsInEmptyFramesAsWrong) {
  JointPrecision precision;
  precision.add(kHead, {proposal(0.9F, 0.F)}, {}, 0);
  EXPECT_TRUE(precision.averages().empty()) << "nothing was there to be found";
  precision.add(kHead, {proposal(0.5F, 0.F)}, {{{0.F, 0.F, 2.F}}}, 1);
  EXPECT_DOUBLE_EQ(average(precision), 0.5);
}

/// Returns recall and precision at every threshold, integrated over steps of recall.
double slow_average(const std::vector<std::pair<float, bool>>& judged, int known) {
  double area = 0.0;
  for (int found = 1; found <= known; ++found) {
    double best = 0.0;
    for (const auto& [threshold, unused] : judged) {
      int right = 0, all = 0;
      for (const auto& [score, is_right] : judged) {
        if (score < threshold) continue;
        ++all;
        right += is_right ? 1 : 0;
      }
      if (right >= found) best = std::max(best, static_cast<double>(right) / all);
    }
    area += best / known;
  }
  return area;
}

TEST(JointPrecision, IsTheAreaUnderTheCurveInAnyOrderOfFrames) {
  Random random(4);
  for (int round = 0; round < 50; ++round) {
    JointPrecision forward, backward;
    std::vector<JointPrecision> frames;
    std::vector<std::pair<float, bool>> judged;
    for (int i = 0; i < 30; ++i) {
      const float score = static_cast<float>(random.below(8)) / 8.F;  // many scores are equal
      const bool right = random.below(2) == 0;
      frames.emplace_back().add(kHead, {proposal(score, right ? 0.F : 1.F)}, {{{0.F, 0.F, 2.F}}}, 1);
      judged.emplace_back(score, right);
    }
    for (const JointPrecision& frame : frames) forward.add(frame);
    for (std::size_t i = frames.size(); i-- > 0;) backward.add(frames[i]);
    EXPECT_NEAR(average(forward), slow_average(judged, 30), 1e-12);
    EXPECT_EQ(average(forward), average(backward));
  }
}

/// Returns a frame of a wall at 2 m whose left half is person 0; a pixel is 1 cm^2 there.
TrueFrame half_a_wall() {
  TrueFrame frame;
  frame.frame.camera = {100, 100, 200.F, 200.F, 49.5F, 49.5F};
  frame.frame.depth = DepthImage(100, 100, 2000);
  frame.truth.person = Image<std::uint8_t>(100, 100, kBackground);
  for (int v = 0; v < 100; ++v) std::fill_n(frame.truth.person.row(v), 50, std::uint8_t{0});
  return frame;
}

TEST(JointSight, AsksForThePersonsSurfaceNearby) {
  // The person ends at x = 0. Of a circle of 15 cm about a joint 11 cm to the right of that, a segment of 4 cm height
  // and 57 cm^2 is the person's; at 14 cm to the right one of 7 cm^2.
  const std::vector<Sight> sight =
      joint_sight(half_a_wall(), 0, {{-0.2F, 0, 2}, {0.11F, 0, 2}, {0.14F, 0, 2}, {-0.2F, 0, 2.2F}, kUnknown});
  EXPECT_THAT(sight, ElementsAre(Sight::seen, Sight::seen, Sight::hidden, Sight::hidden, Sight::unknown));
}

TEST(JointSight, CountsOnlyPixelsOfThePersonWithAReading) {
  TrueFrame frame = half_a_wall();
  EXPECT_THAT(joint_sight(frame, 1, {{-0.2F, 0, 2}}), ElementsAre(Sight::hidden));
  std::ranges::fill(frame.frame.depth, std::uint16_t{0});
  EXPECT_THAT(joint_sight(frame, 0, {{-0.2F, 0, 2}}), ElementsAre(Sight::hidden));
  frame.truth.person = {};
  EXPECT_THAT(joint_sight(frame, 0, {{-0.2F, 0, 2}}), ElementsAre(Sight::unknown));
}

TEST(SightTerms, TellSeenFromHiddenJoints) {
  const JointPair pair{{{0, 0, 2}, {0, 0, 2}, {0, 0, 2}, {0, 0, 2}, {0, 0, 2}},
                       {{0.05F, 0, 2}, {0.2F, 0, 2}, {0, 0.03F, 2}, kUnknown, {0, 0, 2}}};
  const std::vector<float> confidences{0.95F, 1.F, 0.35F, 0.F, 0.31F};
  const MetricTerms terms =
      sight_terms(pair, confidences, {Sight::seen, Sight::seen, Sight::hidden, Sight::hidden, Sight::unknown});
  EXPECT_DOUBLE_EQ(value_of(terms, "joints.seen.at_10cm"), 0.5);
  EXPECT_NEAR(value_of(terms, "joints.seen.error_m"), 0.125, 1e-6);
  EXPECT_DOUBLE_EQ(value_of(terms, "joints.hidden.at_10cm"), 0.5);  // one was not found
  EXPECT_NEAR(value_of(terms, "joints.hidden.error_m"), 0.03, 1e-6);
  EXPECT_DOUBLE_EQ(value_of(terms, "joints.right_at.90_to_100"), 0.5);
  EXPECT_DOUBLE_EQ(value_of(terms, "joints.right_at.30_to_40"), 1.0);
  EXPECT_DOUBLE_EQ(value_of(terms, "joints.seen.right_at.90_to_100"), 0.5);
  EXPECT_TRUE(std::isnan(value_of(terms, "joints.seen.right_at.30_to_40")));
  EXPECT_DOUBLE_EQ(value_of(terms, "joints.hidden.right_at.30_to_40"), 1.0);
  EXPECT_TRUE(std::isnan(value_of(terms, "joints.right_at.0_to_10")));
  EXPECT_TRUE(std::isnan(value_of(terms, "joints.hidden.right_at.90_to_100")));
}

TEST(SightTerms, LeaveOutJointsWhoseTruthIsUnknown) {
  EXPECT_TRUE(sight_terms({{kUnknown}, {{0, 0, 1}}}, {0.5F}, {Sight::unknown}).empty());
}

}  // namespace

}  // namespace vesalius
