#include "metrics/breakdown_metrics.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <set>

#include "metrics/test_frames.h"

namespace vesalius {
namespace {

using test::capsule_frame;

std::set<std::string> names(const MetricTerms& terms) {
  std::set<std::string> all;
  for (const MetricTerm& term : terms) all.insert(term.id.name());
  return all;
}

TEST(Breakdown, CountsByDistanceHeadingAndVisibleShare) {
  constexpr float kPi = std::numbers::pi_v<float>;
  const Person found;
  EXPECT_THAT(names(breakdown_terms(capsule_frame(2.5F, 0.F), {&found}, paper_body())),
              testing::IsSupersetOf({"distance.2-3m", "heading.front", "visible.75-100%"}));
  EXPECT_THAT(names(breakdown_terms(capsule_frame(3.5F, kPi), {&found}, paper_body())),
              testing::IsSupersetOf({"distance.3-4m", "heading.back"}));
  EXPECT_THAT(names(breakdown_terms(capsule_frame(5.5F, kPi / 2.F), {&found}, paper_body())),
              testing::IsSupersetOf({"distance.4m-", "heading.side"}));
}

TEST(Breakdown, CountsFoundPeople) {
  const TrueFrame frame = capsule_frame(2.5F, 0.F);
  const Person found;
  for (const MetricTerm& term : breakdown_terms(frame, {&found}, paper_body())) EXPECT_EQ(term.numerator, 1.0);
  for (const MetricTerm& term : breakdown_terms(frame, {nullptr}, paper_body())) {
    EXPECT_EQ(term.numerator, 0.0);
    EXPECT_EQ(term.denominator, 1.0);
  }
}

TEST(Breakdown, CountsHiddenPartsAsNotVisible) {
  TrueFrame frame = capsule_frame(2.5F, 0.F);
  for (int v = 45; v < test::kCapsuleCamera.height; ++v) {
    for (int u = 0; u < test::kCapsuleCamera.width; ++u) frame.truth.labels(u, v) = kBackground;
  }
  const auto all = names(breakdown_terms(frame, {nullptr}, paper_body()));
  EXPECT_FALSE(all.contains("visible.75-100%"));
}

TEST(Breakdown, IsEmptyIfNothingIsKnown) {
  TrueFrame frame = capsule_frame(2.5F, 0.F);
  frame.truth = {};
  EXPECT_TRUE(breakdown_terms(frame, {nullptr}, paper_body()).empty());
}

TEST(Breakdown, CountsByPostureStatureAndRoll) {
  TrueFrame frame = capsule_frame(2.5F, 0.F);
  frame.truth.postures = {"sitting"};
  frame.truth.statures_m = {1.62F};
  frame.truth.up = Eigen::Vector3f(0.F, -1.F, 0.F);
  EXPECT_THAT(names(breakdown_terms(frame, {nullptr}, paper_body())),
              testing::IsSupersetOf({"posture.sitting", "stature.1.5-1.65m", "roll.0-15deg"}));
  frame.truth.statures_m = {2.1F};
  frame.truth.up = Eigen::Vector3f(-1.F, 0.F, 0.F);
  EXPECT_THAT(names(breakdown_terms(frame, {nullptr}, paper_body())),
              testing::IsSupersetOf({"stature.1.8m-", "roll.75-105deg"}));
}

TEST(Breakdown, TakesTheHeadingOfAFrameOrOfItsJoints) {
  TrueFrame frame = capsule_frame(2.5F, 0.F);
  frame.truth = {};
  frame.truth.heading = Heading::back;
  EXPECT_THAT(names(breakdown_terms(frame, {nullptr}, paper_body())), testing::ElementsAre("heading.back"));
  frame.truth.heading.reset();
  frame.truth.joint_names = {"head", "l_hip", "r_hip"};
  frame.truth.joints = {{{0, -1, 2}, {0.2F, 0, 2}, {-0.2F, 0, 2}}};
  EXPECT_THAT(names(breakdown_terms(frame, {nullptr}, paper_body())), testing::ElementsAre("heading.front"));
}

TEST(Breakdown, KnowsTheRollOfACamera) {
  FrameTruth truth;
  EXPECT_FALSE(camera_roll_deg(truth));
  constexpr float kTilt = 0.5F;
  for (const float roll_rad : {0.F, 0.6F, -0.6F, 2.9F}) {
    truth.up =
        Eigen::Vector3f(std::cos(kTilt) * std::sin(roll_rad), -std::cos(kTilt) * std::cos(roll_rad), std::sin(kTilt));
    EXPECT_NEAR(*camera_roll_deg(truth), std::abs(roll_rad) * 57.29578, 1e-3);
  }
  truth.up = Eigen::Vector3f(0.1F, 0.F, -1.F).normalized();  // looks straight down
  EXPECT_FALSE(camera_roll_deg(truth));
}

}  // namespace
}  // namespace vesalius
