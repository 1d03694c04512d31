#include "metrics/people_metrics.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "metrics/test_frames.h"
#include "metrics/test_terms.h"

namespace vesalius {
namespace {

using test::value_of;

const Camera kCamera{4, 1, 20.F, 20.F, 1.5F, 0.F};  // at 1 m a pixel is 25 cm^2
constexpr std::uint8_t kNone = kBackground;

/// Returns a frame with two pixels of the left foot, one of the neck and one of nobody.
TrueFrame frame_of_pixels() {
  TrueFrame frame;
  frame.frame.camera = kCamera;
  frame.frame.depth = DepthImage(4, 1, 1000);
  frame.truth.people = 1;
  frame.truth.person = Image<std::uint8_t>(4, 1, 0);
  frame.truth.labels = LabelImage(4, 1, kNone);
  frame.truth.labels(0, 0) = 0;
  frame.truth.labels(1, 0) = 0;
  frame.truth.labels(2, 0) = 10;
  frame.truth.person(3, 0) = kNone;
  return frame;
}

Person person_with(const std::vector<std::pair<int, Eigen::Vector3f>>& observed, Mask mask) {
  Person person;
  person.skeleton.parts.resize(paper_body().parts.size());
  for (const auto& [part, centre] : observed) {
    person.skeleton.parts[part].state = State::observed;
    person.skeleton.parts[part].centre = centre;
  }
  person.mask = std::move(mask);
  return person;
}

TEST(VisibleParts, LieAtTheMeanOfTheirPixels) {
  const std::vector<Eigen::Vector3f> parts = visible_parts(frame_of_pixels(), 0, paper_body());
  EXPECT_NEAR(parts[0].x(), -0.05, 1e-6);  // pixels at -1.5 and -0.5, with 20 pixels per metre
  EXPECT_NEAR(parts[10].x(), 0.025, 1e-6);
  EXPECT_NEAR(parts[10].z(), 1.0, 1e-6);
  EXPECT_TRUE(parts[1].hasNaN());
}

TEST(VisibleParts, LeaveOutPartsThatAreMostlyHidden) {
  TrueFrame frame = frame_of_pixels();
  std::ranges::fill(frame.frame.depth, std::uint16_t{800});  // 16 cm^2 a pixel
  const std::vector<Eigen::Vector3f> parts = visible_parts(frame, 0, paper_body());
  EXPECT_FALSE(parts[0].hasNaN());
  EXPECT_TRUE(parts[10].hasNaN());
}

TEST(CountParts, CountsAPartAsRightIfItIsObservedNearby) {
  const std::vector<Eigen::Vector3f> visible = visible_parts(frame_of_pixels(), 0, paper_body());
  const Person near = person_with({{0, {-0.05F, 0, 1.1F}}, {10, {0.025F, 0, 1.2F}}, {11, {0, 0, 1}}}, Mask(4, 1, 1));
  const PartCounts counts = count_parts(near.skeleton, visible, paper_body());
  EXPECT_EQ(counts.visible, 2);  // the arm cannot be seen
  EXPECT_EQ(counts.right, 1);    // the neck is 20 cm off
  EXPECT_EQ(counts.visible_upper, 1);
  EXPECT_EQ(counts.right_upper, 0);
  const PartCounts on_trust = count_parts(near.skeleton, {}, paper_body());
  EXPECT_EQ(on_trust.visible, 25);
  EXPECT_EQ(on_trust.right, 3);
  EXPECT_EQ(on_trust.visible_upper, 17);
  EXPECT_EQ(on_trust.right_upper, 2);
}

TEST(FoundPartTerms, CountVisiblePartsOfPeopleWithEnoughParts) {
  const std::vector<Eigen::Vector3f> visible = visible_parts(frame_of_pixels(), 0, paper_body());
  Skeleton skeleton =
      person_with({{0, {-0.05F, 0, 1.1F}}, {10, {0.025F, 0, 1.2F}}, {11, {0, 0, 1}}}, Mask(4, 1, 1)).skeleton;
  const auto terms_with = [&](int parts) {
    skeleton.found = parts;
    return found_part_terms(skeleton, visible, paper_body());
  };
  EXPECT_TRUE(terms_with(3).empty());
  EXPECT_EQ(terms_with(4).size(), 2U);  // the arm cannot be seen
  EXPECT_DOUBLE_EQ(value_of(terms_with(4), "part.right_of_4.l_foot"), 1.0);
  EXPECT_DOUBLE_EQ(value_of(terms_with(4), "part.right_of_4.neck"), 0.0);  // 20 cm off
  EXPECT_EQ(terms_with(7).size(), 2U);
  EXPECT_DOUBLE_EQ(value_of(terms_with(8), "part.right_of_8.l_foot"), 1.0);
  EXPECT_DOUBLE_EQ(value_of(terms_with(8), "part.right_of_4.l_foot"), 1.0);
}

TEST(VisiblePartTerms, CountNoPartOfMissedPeopleAsRight) {
  const TrueFrame frame = frame_of_pixels();
  const Person person = person_with({{10, {0.025F, 0, 1.F}}}, Mask(4, 1, 1));
  EXPECT_DOUBLE_EQ(value_of(visible_part_terms(frame, {&person}, paper_body()), "parts.right"), 0.5);
  EXPECT_DOUBLE_EQ(value_of(visible_part_terms(frame, {&person}, paper_body()), "parts.right_upper"), 1.0);
  EXPECT_DOUBLE_EQ(value_of(visible_part_terms(frame, {nullptr}, paper_body()), "parts.right"), 0.0);
}

TEST(PeopleTerms, AgreeWithCountingByHand) {
  TrueFrame frame = frame_of_pixels();
  frame.truth.labels = {};
  frame.truth.person = {};
  frame.truth.people = 2;
  frame.truth.posture = "sitting";
  frame.truth.mask = Mask(4, 1, 1);
  Mask half(4, 1, 0);
  half(0, 0) = half(1, 0) = 1;
  const std::vector<Person> people{person_with({{10, {0, 0, 1}}}, half), person_with({}, half)};
  const std::vector<Match> matches{{Match::Kind::person, 0}, {Match::Kind::nobody, -1}};
  const MetricTerms terms = people_terms(frame, people, matches, paper_body());
  EXPECT_DOUBLE_EQ(value_of(terms, "people.found"), 0.5);
  EXPECT_DOUBLE_EQ(value_of(terms, "people.false"), 1.0);
  EXPECT_DOUBLE_EQ(value_of(terms, "posture.sitting"), 0.5);
  EXPECT_DOUBLE_EQ(value_of(terms, "mask.iou"), 0.5);
  EXPECT_DOUBLE_EQ(value_of(terms, "mask.iou_where_found"), 0.5);
  EXPECT_DOUBLE_EQ(value_of(terms, "part.seen.neck"), 0.5);
  EXPECT_DOUBLE_EQ(value_of(terms, "part.seen.l_foot"), 0.0);
  EXPECT_TRUE(std::isnan(value_of(terms, "frames.empty_with_person")));
}

TEST(PeopleTerms, CountOnlyFalsePeopleInAnEmptyFrame) {
  TrueFrame frame = frame_of_pixels();
  frame.truth = {};
  frame.truth.people = 0;
  frame.truth.posture = "empty";
  const MetricTerms quiet = people_terms(frame, {}, {}, paper_body());
  EXPECT_DOUBLE_EQ(value_of(quiet, "frames.empty_with_person"), 0.0);
  EXPECT_EQ(quiet.size(), 2U);
  const std::vector<Person> ghost{person_with({}, Mask(4, 1, 1))};
  const MetricTerms haunted = people_terms(frame, ghost, {{Match::Kind::nobody, -1}}, paper_body());
  EXPECT_DOUBLE_EQ(value_of(haunted, "frames.empty_with_person"), 1.0);
  EXPECT_DOUBLE_EQ(value_of(haunted, "people.false"), 1.0);
}

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

/// Returns four frames with three people. Two people are found, one of them poorly; two proposals show nobody.
DetectionLog by_hand() {
  DetectionLog log;
  log.frames = 4;
  log.expected = 3;
  log.proposals = {
      {0.9F, 20, true, {25, 20, 17, 15}}, {0.4F, 6, true, {10, 4, 10, 4}}, {0.7F, 5, false, {}}, {0.2F, 9, false, {}}};
  return log;
}

TEST(DetectionCurve, OverPartsAgreesWithCountingByHand) {
  const auto curve = sweep_parts(by_hand(), 25, 0.3);
  ASSERT_EQ(curve.size(), 25U);
  EXPECT_DOUBLE_EQ(curve[0].threshold, 1.0);
  EXPECT_DOUBLE_EQ(curve[3].rate, 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(curve[3].false_per_frame, 0.25);
  EXPECT_DOUBLE_EQ(curve[3].part_rate, 24.0 / 35.0);
  EXPECT_DOUBLE_EQ(curve[3].upper_part_rate, 19.0 / 27.0);
  EXPECT_DOUBLE_EQ(curve[5].false_per_frame, 0.0);  // 6 parts
  EXPECT_DOUBLE_EQ(curve[5].rate, 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(curve[6].rate, 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(curve[6].part_rate, 0.8);
  EXPECT_DOUBLE_EQ(curve[20].rate, 0.0);
  EXPECT_TRUE(std::isnan(curve[20].part_rate));
}

TEST(DetectionCurve, OverScoreAgreesWithCountingByHand) {
  const auto curve = sweep_score(by_hand(), 10, 6);
  ASSERT_EQ(curve.size(), 11U);
  EXPECT_DOUBLE_EQ(curve[0].rate, 2.0 / 3.0);
  EXPECT_DOUBLE_EQ(curve[0].false_per_frame, 0.25);
  EXPECT_DOUBLE_EQ(curve[3].false_per_frame, 0.0);
  EXPECT_DOUBLE_EQ(curve[5].rate, 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(curve[10].rate, 0.0);
}

TEST(DetectionCurve, FallsWithItsThreshold) {
  for (const auto& curve : {sweep_parts(by_hand(), 25, 0.0), sweep_score(by_hand(), 50, 1)}) {
    for (std::size_t i = 1; i < curve.size(); ++i) {
      EXPECT_LE(curve[i].rate, curve[i - 1].rate);
      EXPECT_LE(curve[i].false_per_frame, curve[i - 1].false_per_frame);
    }
  }
}

TEST(DetectionCurve, HasNoRateWithoutPeople) {
  DetectionLog log;
  log.frames = 2;
  EXPECT_TRUE(std::isnan(sweep_parts(log, 1, 0.0)[0].rate));
  EXPECT_DOUBLE_EQ(sweep_parts(log, 1, 0.0)[0].false_per_frame, 0.0);
}

}  // namespace

}  // namespace vesalius
