#include "metrics/side_metrics.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "metrics/test_frames.h"
#include "metrics/test_terms.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;
using test::value_of;

constexpr float kHalfTurn = std::numbers::pi_v<float>;
const Vector3f kNothing = Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());

TrueFrame frame_of(float turn_rad) { return test::capsule_frame(2.5F, turn_rad, 0.9F); }

/// Returns a person with every part observed at its true centre, moved by `shift`; if `mirrored`, at its partner's.
Person person_at(const TrueFrame& frame, bool mirrored, const Vector3f& shift = Vector3f::Zero()) {
  Person person;
  for (const BodyPart& part : paper_body().parts) {
    const int own = paper_body().find_part(part.name);
    SkeletonPart& found = person.skeleton.parts.emplace_back();
    found.state = State::observed;
    found.centre = frame.truth.parts[0][mirrored ? part.mirror : own] + shift;
  }
  return person;
}

TEST(GivenParts, AreAllRightAtTheTruth) {
  const TrueFrame frame = frame_of(0.F);
  const Person person = person_at(frame, false);
  const MetricTerms terms = given_part_terms(frame, {&person}, paper_body());
  EXPECT_EQ(value_of(terms, "given.right"), 1.0);
  EXPECT_EQ(value_of(terms, "given.mirrored"), 0.0);
  EXPECT_EQ(value_of(terms, "given.right.front"), 1.0);
  EXPECT_TRUE(std::isnan(value_of(terms, "given.right.back")));
  EXPECT_EQ(value_of(terms, "sides.swapped"), 0.0);
}

TEST(GivenParts, OfAMirroredSkeletonAreSwapped) {
  const TrueFrame frame = frame_of(kHalfTurn);
  const Person person = person_at(frame, true);
  const MetricTerms terms = given_part_terms(frame, {&person}, paper_body());
  EXPECT_EQ(value_of(terms, "sides.swapped"), 1.0);
  EXPECT_EQ(value_of(terms, "sides.swapped.back"), 1.0);
  EXPECT_GT(value_of(terms, "given.mirrored.back"), 0.5);  // sides of the trunk are near each other, so they are right
  EXPECT_NEAR(value_of(terms, "given.right") + value_of(terms, "given.mirrored"), 1.0, 1e-12);
}

TEST(GivenParts, FarFromBothSidesAreNeither) {
  const TrueFrame frame = frame_of(0.F);
  const Person person = person_at(frame, false, {0.F, 0.F, 3.F});
  const MetricTerms terms = given_part_terms(frame, {&person}, paper_body());
  EXPECT_EQ(value_of(terms, "given.right"), 0.0);
  EXPECT_EQ(value_of(terms, "given.mirrored"), 0.0);
}

TEST(GivenParts, AreThoseThatWereObservedOnPeopleWhoWereFound) {
  const TrueFrame frame = frame_of(0.F);
  EXPECT_TRUE(given_part_terms(frame, {nullptr}, paper_body()).empty());
  Person person = person_at(frame, false, {0.F, 0.F, 3.F});
  for (SkeletonPart& part : person.skeleton.parts) part.state = State::predicted;
  EXPECT_TRUE(given_part_terms(frame, {&person}, paper_body()).empty());
  person.skeleton.parts[0].state = State::observed;
  const MetricTerms terms = given_part_terms(frame, {&person}, paper_body());
  EXPECT_EQ(value_of(terms, "given.right"), 0.0);
}

TEST(GivenPoints, AreCountedByHand) {
  const SidedNames names = sided(std::vector<std::string>{"head", "l_hand", "r_hand", "l_foot"});
  EXPECT_EQ(names.partner, (std::vector<int>{-1, 2, 1, -1}));
  const std::vector<Vector3f> truth{{0, -1, 2}, {0.4F, 0, 2}, {-0.4F, 0, 2}, {0, 1, 2}};
  const GivenPoints points =
      count_given(names, {{0, -1.05F, 2}, {-0.4F, 0, 2.05F}, {0.05F, 0, 2}, kNothing}, truth, 0.1);
  EXPECT_EQ(points.right, 1);     // the head
  EXPECT_EQ(points.mirrored, 1);  // the left hand
  EXPECT_EQ(points.all, 3);       // and the right hand, in the middle
  EXPECT_EQ(points.paired, 2);
  EXPECT_EQ(points.swapped, 2);
  const MetricTerms terms = given_terms(points, GivenKind::joints, Heading::side, true);
  EXPECT_DOUBLE_EQ(value_of(terms, "joints.given_right.side"), 1.0 / 3.0);
  EXPECT_EQ(value_of(terms, "sides.swapped.side"), 1.0);
  EXPECT_EQ(value_of(terms, "joints.swapped"), 1.0);
}

TEST(GivenPoints, AreNotSwappedWhereHalfOfThemAre) {
  const GivenPoints half{.all = 4, .right = 2, .mirrored = 2, .paired = 4, .swapped = 2};
  EXPECT_EQ(value_of(given_terms(half, GivenKind::parts, std::nullopt, true), "sides.swapped"), 0.0);
}

TEST(SideOrder, FollowsTheHeading) {
  for (const float turn : {0.F, kHalfTurn}) {
    const TrueFrame frame = frame_of(turn);
    const std::string side = turn == 0.F ? "front" : "back";
    const Person right = person_at(frame, false), mirrored = person_at(frame, true);
    for (const std::string metric : {"sides.order", "sides.order_arms"}) {
      EXPECT_EQ(value_of(side_order_terms(frame, {&right}, paper_body()), metric + "." + side), 1.0) << side;
      EXPECT_EQ(value_of(side_order_terms(frame, {&mirrored}, paper_body()), metric + "." + side), 0.0) << side;
    }
  }
}

TEST(SideOrder, NeedsTheFramesHeadingAlone) {
  TrueFrame frame = frame_of(0.F);
  const Person person = person_at(frame, false);
  frame.truth = {};
  EXPECT_TRUE(side_order_terms(frame, {&person}, paper_body()).empty());
  frame.truth.heading = Heading::back;
  EXPECT_EQ(value_of(side_order_terms(frame, {&person}, paper_body()), "sides.order.back"), 0.0);
  frame.truth.heading = Heading::side;
  EXPECT_TRUE(side_order_terms(frame, {&person}, paper_body()).empty());
}

TEST(SideOrder, LeavesOutPeopleWhoAreNotUprightInThePicture) {
  TrueFrame frame = frame_of(0.F);
  const Person person = person_at(frame, false);
  frame.truth.postures = {"lying"};
  EXPECT_TRUE(side_order_terms(frame, {&person}, paper_body()).empty());
  frame.truth.postures = {"sitting"};
  frame.truth.up = Vector3f(1, 0, 0);
  EXPECT_TRUE(side_order_terms(frame, {&person}, paper_body()).empty());
  frame.truth.up = Vector3f(0, -1, 0);
  EXPECT_FALSE(side_order_terms(frame, {&person}, paper_body()).empty());
}

TEST(Yaw, IsRightWithin45DegreesOfTheTrueOne) {
  const TrueFrame frame = frame_of(kHalfTurn);
  Person person = person_at(frame, false);
  EXPECT_TRUE(yaw_terms(frame, {&person}, paper_body()).empty());  // none was given
  person.yaw = YawEstimate{-kHalfTurn + 0.7F, 0.95F};
  const MetricTerms near = yaw_terms(frame, {&person}, paper_body());
  EXPECT_EQ(value_of(near, "yaw.right"), 1.0);
  EXPECT_EQ(value_of(near, "yaw.right.back"), 1.0);
  EXPECT_EQ(value_of(near, "yaw.right_at.90_to_97"), 1.0);
  person.yaw = YawEstimate{0.F, 0.2F};
  const MetricTerms far = yaw_terms(frame, {&person, nullptr}, paper_body());
  EXPECT_EQ(value_of(far, "yaw.right"), 0.0);
  EXPECT_EQ(value_of(far, "yaw.right_at.below_60"), 0.0);
}

}  // namespace
}  // namespace vesalius
