#include "metrics/unseen_metrics.h"

#include <gtest/gtest.h>

#include "metrics/test_terms.h"

namespace vesalius {
namespace {

constexpr int kWidth = 40, kHeight = 30;
constexpr Camera kView{kWidth, kHeight, 40.F, 40.F, 19.5F, 14.5F};
constexpr std::uint8_t kOwnPart = 3, kOtherPart = 4;

/// Two people, of whom nothing is in the picture yet, before a wall.
TrueFrame before_a_wall() {
  TrueFrame frame;
  frame.frame = depth_frame(DepthImage(kWidth, kHeight, 4000), kView);
  frame.truth.people = 2;
  frame.truth.person = Image<std::uint8_t>(kWidth, kHeight, kBackground);
  frame.truth.labels = LabelImage(kWidth, kHeight, kBackground);
  return frame;
}

void fill(TrueFrame& frame, std::uint16_t mm, std::uint8_t person = kBackground, std::uint8_t part = kOtherPart) {
  for (int v = 5; v < 25; ++v) {
    for (int u = 10; u < 30; ++u) {
      frame.frame.depth(u, v) = mm;
      frame.truth.person(u, v) = person;
      frame.truth.labels(u, v) = person == kBackground ? kBackground : part;
    }
  }
}

const TrueJoint kElbow{{0.F, 0.F, 2.F}, {kOwnPart}};

TEST(TrueReason, IsWhatTheFrameShowsAtTheTruePlace) {
  TrueFrame frame = before_a_wall();
  EXPECT_EQ(true_reason(frame, 0, {{1.2F, 0.F, 2.F}, {}}).unseen, Unseen::out_of_picture);
  EXPECT_EQ(true_reason(frame, 0, {{0.F, 0.F, -1.F}, {}}).unseen, Unseen::out_of_picture);
  EXPECT_EQ(true_reason(frame, 0, kElbow).unseen, Unseen::not_sure);
  fill(frame, 0);
  EXPECT_EQ(true_reason(frame, 0, kElbow).unseen, Unseen::no_depth);
  fill(frame, 1500);
  EXPECT_EQ(true_reason(frame, 0, kElbow).unseen, Unseen::behind_something);
  fill(frame, 1500, 1);
  EXPECT_EQ(true_reason(frame, 0, kElbow).unseen, Unseen::behind_person);
  EXPECT_EQ(true_reason(frame, 0, kElbow).behind, 1);
  EXPECT_EQ(true_reason(frame, 1, kElbow).behind, 1);
  fill(frame, 1900, 0);
  EXPECT_EQ(true_reason(frame, 0, kElbow).unseen, Unseen::not_sure) << "its flesh";
  fill(frame, 1500, 0, kOwnPart);
  EXPECT_EQ(true_reason(frame, 0, kElbow).unseen, Unseen::not_sure) << "its own part";
}

/// Terms of an elbow that is given so for true person 0, whom the second of two found people shows.
MetricTerms terms_of(const TrueFrame& frame, State state, Unseen unseen, int behind) {
  JointSet set;
  set.joints.resize(1);
  set.joints[0].name = "l_elbow";
  set.joints[0].parts = {kOwnPart};
  return unseen_terms(frame, 0, {"l_elbow"}, {kElbow.at}, set, {{state, kElbow.at, 0.35F, unseen, behind}}, {1, 0});
}

TEST(UnseenTerms, CountReasonsThatAreRight) {
  TrueFrame frame = before_a_wall();
  fill(frame, 1500);
  const MetricTerms right = terms_of(frame, State::predicted, Unseen::behind_something, -1);
  EXPECT_EQ(test::value_of(right, "unseen.right"), 1.0);
  EXPECT_EQ(test::value_of(right, "unseen.right_at.30_to_40"), 1.0);
  EXPECT_EQ(test::value_of(right, "unseen.given.behind_something_as_behind_something"), 1.0);
  EXPECT_EQ(test::value_of(right, "unseen.given.behind_something_as_no_depth"), 0.0);
  const MetricTerms wrong = terms_of(frame, State::none, Unseen::no_depth, -1);
  EXPECT_EQ(test::value_of(wrong, "unseen.right"), 0.0);
  EXPECT_EQ(test::value_of(wrong, "unseen.given.behind_something_as_no_depth"), 1.0);
  EXPECT_TRUE(terms_of(frame, State::observed, Unseen::none, -1).empty());
}

TEST(UnseenTerms, WhoHidesAJointMustBeTheRightOne) {
  TrueFrame frame = before_a_wall();
  fill(frame, 1500, 1);
  EXPECT_EQ(test::value_of(terms_of(frame, State::predicted, Unseen::behind_person, 0), "unseen.right"), 1.0);
  const MetricTerms itself = terms_of(frame, State::predicted, Unseen::behind_person, 1);
  EXPECT_EQ(test::value_of(itself, "unseen.right"), 0.0);
  EXPECT_EQ(test::value_of(itself, "unseen.given.behind_other_as_behind_itself"), 1.0);
  const MetricTerms third = terms_of(frame, State::predicted, Unseen::behind_person, 2);
  EXPECT_EQ(test::value_of(third, "unseen.right"), 0.0);
  EXPECT_EQ(test::value_of(third, "unseen.given.behind_other_as_behind_other"), 1.0);
  fill(frame, 1500, 0);
  EXPECT_EQ(test::value_of(terms_of(frame, State::predicted, Unseen::behind_person, 1), "unseen.right"), 1.0);
}

TEST(UnseenTerms, AreNoneWherePeopleAreNotKnownApart) {
  TrueFrame frame = before_a_wall();
  frame.truth.person = {};
  EXPECT_TRUE(terms_of(frame, State::predicted, Unseen::no_depth, -1).empty());
}

}  // namespace
}  // namespace vesalius
