#include "metrics/people_metrics.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

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

}  // namespace
}  // namespace vesalius
