#include "metrics/motion_metrics.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "metrics/test_terms.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;
using test::value_of;

constexpr double kRate = 30.0;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
const Vector3f kNothing = Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());

/// Returns a person of one joint at 30 Hz. `truth` and `found` give its x by the frame.
template <class Truth, class Found>
PersonMotion moving(int frames, const Truth& truth, const Found& found) {
  PersonMotion person;
  for (int i = 0; i < frames; ++i) {
    MotionStep step{static_cast<std::size_t>(i), i / kRate, {}, {}};
    step.truth = {{static_cast<float>(truth(i)), 0, 2}};
    step.found = {{static_cast<float>(found(i)), 0, 2}};
    step.true_bones_m.fill(kNaN);
    step.found_bones_m.fill(kNaN);
    step.id = 1;
    step.track_age = i;
    person.push_back(step);
  }
  return person;
}

MetricTerms terms_of(const PersonMotion& person) {
  std::vector<MetricTerms> frames(person.back().frame + 1);
  add_motion_terms({person}, frames);
  MetricTerms all;
  for (const MetricTerms& terms : frames) all.insert(all.end(), terms.begin(), terms.end());
  return all;
}

double still(int) { return 0.0; }

TEST(Jitter, IsTheSecondDifferenceTimesTheSquareOfTheRate) {
  // A joint that jumps to and fro by 1 mm has second differences of 2 mm.
  const auto person = moving(20, still, [](int i) { return i % 2 == 0 ? 0.0 : 0.001; });
  EXPECT_NEAR(value_of(terms_of(person), "joints.jitter_mm_s2"), 2.0 * kRate * kRate, 1.0);
  EXPECT_DOUBLE_EQ(value_of(terms_of(person), "joints.true_jitter_mm_s2"), 0.0);
}

TEST(Jitter, IsTheAccelerationOfASmoothPathAndNoneOfAnEvenOne) {
  const auto person = moving(
      20, [](int i) { return 0.5 * 1.2 * (i / kRate) * (i / kRate); }, [](int i) { return 0.9 * (i / kRate); });
  EXPECT_NEAR(value_of(terms_of(person), "joints.true_jitter_mm_s2"), 1200.0, 1.0);
  EXPECT_NEAR(value_of(terms_of(person), "joints.jitter_mm_s2"), 0.0, 1.0);
}

TEST(Jitter, LeavesOutGapsAndOtherIds) {
  auto jump = [](int i) { return i < 10 ? 0.0 : 1.0; };
  auto person = moving(20, still, jump);
  EXPECT_GT(value_of(terms_of(person), "joints.jitter_mm_s2"), 1000.0);
  for (int i = 10; i < 20; ++i) person[i].id = 2;
  EXPECT_DOUBLE_EQ(value_of(terms_of(person), "joints.jitter_mm_s2"), 0.0);
  person = moving(20, still, jump);
  for (int i = 10; i < 20; ++i) person[i].time_s += 1.0;
  EXPECT_DOUBLE_EQ(value_of(terms_of(person), "joints.jitter_mm_s2"), 0.0);
  person = moving(20, still, jump);
  person[9].found = person[10].found = {kNothing};
  EXPECT_DOUBLE_EQ(value_of(terms_of(person), "joints.jitter_mm_s2"), 0.0);
}

TEST(Bones, HaveErrorsAndSpreadAfterTheThirtiethFrame) {
  auto person = moving(100, still, still);
  for (MotionStep& step : person) {
    step.true_bones_m[3] = 0.4;  // left shin
    // Wrong by half at first, then by 10 % and 20 % in turn.
    step.found_bones_m[3] = step.track_age < kSettledFrames ? 0.6 : step.track_age % 2 == 0 ? 0.44 : 0.48;
  }
  const MetricTerms terms = terms_of(person);
  EXPECT_NEAR(value_of(terms, "bones.error"), 0.15, 1e-9);
  EXPECT_NEAR(value_of(terms, "bones.spread"), 0.05, 1e-9);
}

TEST(Bones, OfAShortTrackHaveNoSpread) {
  auto person = moving(50, still, still);
  for (MotionStep& step : person) step.true_bones_m[0] = step.found_bones_m[0] = 0.3;
  EXPECT_DOUBLE_EQ(value_of(terms_of(person), "bones.error"), 0.0);
  EXPECT_TRUE(std::isnan(value_of(terms_of(person), "bones.spread")));
}

TEST(BoneLengths, AreThoseBetweenTheirJoints) {
  const BoneLengths lengths =
      bone_lengths({"r_hip", "r_knee", "l_hip", "r_ankle"}, {{0, 0, 2}, {0, 0.45F, 2}, {0.2F, 0, 2}, {0, 0.85F, 2}});
  EXPECT_NEAR(lengths[6], 0.45, 1e-6);  // right thigh
  EXPECT_NEAR(lengths[7], 0.40, 1e-6);  // right shin
  EXPECT_TRUE(std::isnan(lengths[2]));
}

TEST(BoneLengths, TakeAnotherJointSetWhereTheWantedOneLacksAnEnd) {
  const BodyModel& body = paper_body();
  std::vector<std::vector<Joint>> joints(body.joint_sets.size());
  for (std::size_t s = 0; s < joints.size(); ++s) {
    for (std::size_t j = 0; j < body.joint_sets[s].joints.size(); ++j) {
      const bool knee = body.joint_sets[s].joints[j].name == "l_knee";
      joints[s].push_back({State::observed, {0, knee ? 0.1F * static_cast<float>(s + 1) : 0.F, 2}, 1.F});
    }
  }
  ASSERT_EQ(body.joint_sets[0].name, "nite15");
  const BoneLengths lengths = bone_lengths(body, "nite15", joints);
  EXPECT_NEAR(lengths[2], 0.1, 1e-6);  // hip and knee are in nite15,
  EXPECT_NEAR(lengths[3], 0.2, 1e-6);  // the ankle is first in the set after it
}

}  // namespace
}  // namespace vesalius
