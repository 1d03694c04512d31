#include "metrics/joint_precision.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;

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

}  // namespace
}  // namespace vesalius
