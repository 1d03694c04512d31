#include "vesalius/explain_unseen.h"

#include <gtest/gtest.h>

#include <limits>

namespace vesalius {
namespace {

constexpr int kWidth = 160, kHeight = 120, kHandPart = 0, kChestPart = 1;
constexpr Camera kCamera{kWidth, kHeight, 130.F, 130.F, 79.5F, 59.5F};
const Eigen::Vector3f kPlace{0.1F, 0.1F, 2.F};

/// A body with a hand and a chest, which each are a joint.
BodyModel two_parts() {
  BodyModel body;
  body.parts.resize(2);
  JointSet set;
  set.name = "two";
  set.joints.resize(2);
  for (int j = 0; j < 2; ++j) {
    set.joints[static_cast<std::size_t>(j)].parts = {j};
    set.joints[static_cast<std::size_t>(j)].weights = {1.F};
  }
  body.joint_sets = {set};
  return body;
}

/// A frame with a wall, and people with a hand that is predicted and a chest that is observed.
class ExplainUnseen : public testing::Test {
 protected:
  ExplainUnseen() : frame_(depth_frame(DepthImage(kWidth, kHeight, 4000), kCamera)) {}

  std::size_t add_person(const Eigen::Vector3f& hand, State state = State::predicted) {
    Person& person = people_.emplace_back();
    person.mask = Mask(kWidth, kHeight, 0);
    person.labels = LabelImage(kWidth, kHeight, kBackground);
    person.skeleton.parts.resize(2);
    person.skeleton.parts[kHandPart].state = state;
    person.skeleton.parts[kHandPart].centre = hand;
    person.skeleton.parts[kChestPart].state = State::observed;
    person.joints = {{{state, hand, 0.5F}, {State::observed, {0.F, 0.F, 2.F}, 0.9F}}};
    return people_.size() - 1;
  }

  /// Fills the picture within so many pixels of a point; `who` is the index of whose pixels they are, -1 for nobody's.
  void fill_about(const Eigen::Vector3f& place, std::uint16_t mm, int who = -1, int part = kChestPart, int px = 20) {
    const Eigen::Vector2f centre = kCamera.pixel(place);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        if (std::abs(float(u) - centre.x()) > float(px) || std::abs(float(v) - centre.y()) > float(px)) continue;
        frame_.depth(u, v) = mm;
        if (who < 0) continue;
        people_[static_cast<std::size_t>(who)].mask(u, v) = 1;
        people_[static_cast<std::size_t>(who)].labels(u, v) = static_cast<std::uint8_t>(part);
      }
    }
  }

  /// Returns the first person's hand, of which the joint must tell the same as the part.
  const Joint& hand() {
    explain_unseen(frame_, body_, people_);
    const Joint& joint = people_[0].joints[0][kHandPart];
    EXPECT_EQ(people_[0].skeleton.parts[kHandPart].unseen, joint.unseen);
    EXPECT_EQ(people_[0].skeleton.parts[kHandPart].behind, joint.behind);
    return joint;
  }

  BodyModel body_ = two_parts();
  Frame frame_;
  std::vector<Person> people_;
};

TEST_F(ExplainUnseen, WhatIsObservedHasNoReason) {
  add_person(kPlace, State::observed);
  fill_about(kPlace, 1000);
  EXPECT_EQ(hand().unseen, Unseen::none);
  EXPECT_EQ(hand().behind, -1);
}

TEST_F(ExplainUnseen, BeyondThePictureOrBehindTheCameraItIsOutOfThePicture) {
  add_person({2.F, 0.F, 2.F});
  EXPECT_EQ(hand().unseen, Unseen::out_of_picture);
  people_.clear();
  add_person({0.F, 0.F, -1.F});
  EXPECT_EQ(hand().unseen, Unseen::out_of_picture);
  people_.clear();
  add_person({1e30F, 0.F, 0.1F});
  EXPECT_EQ(hand().unseen, Unseen::out_of_picture);
}

TEST_F(ExplainUnseen, ABorderWithoutReadingsIsOutOfThePicture) {
  add_person(kCamera.point(float(kWidth - 3), 60.F, 2.F));
  fill_about(kCamera.point(float(kWidth - 1), 60.F, 2.F), 0, -1, 0, kHeight);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth - 12; ++u) frame_.depth(u, v) = 4000;
  }
  EXPECT_EQ(hand().unseen, Unseen::out_of_picture);
  frame_.depth(kWidth - 1, 0) = 4000;  // the border has a reading: there is a picture, with a hole
  EXPECT_EQ(hand().unseen, Unseen::no_depth);
}

TEST_F(ExplainUnseen, BehindAWallItIsBehindSomething) {
  add_person(kPlace);
  fill_about(kPlace, 1500);
  EXPECT_EQ(hand().unseen, Unseen::behind_something);
  EXPECT_EQ(hand().behind, -1);
}

TEST_F(ExplainUnseen, BehindAnotherPersonItSaysWhom) {
  add_person(kPlace);
  add_person({-1.F, 0.F, 2.F});
  const std::size_t other = add_person({0.F, 0.F, 1.5F});
  fill_about(kPlace, 1500, int(other));
  EXPECT_EQ(hand().unseen, Unseen::behind_person);
  EXPECT_EQ(hand().behind, 2);
}

TEST_F(ExplainUnseen, BehindTheOwnBodyItIsThePersonItself) {
  add_person(kPlace);
  fill_about(kPlace, 1700, 0);
  EXPECT_EQ(hand().unseen, Unseen::behind_person);
  EXPECT_EQ(hand().behind, 0);
}

TEST_F(ExplainUnseen, UnderItsOwnFleshNothingHidesIt) {
  add_person(kPlace);
  fill_about(kPlace, 1900, 0);
  EXPECT_EQ(hand().unseen, Unseen::not_sure);
  fill_about(kPlace, 1700, 0, kHandPart);
  EXPECT_EQ(hand().unseen, Unseen::not_sure);
}

TEST_F(ExplainUnseen, InAHoleThereIsNoDepth) {
  add_person(kPlace);
  fill_about(kPlace, 0);
  EXPECT_EQ(hand().unseen, Unseen::no_depth);
}

TEST_F(ExplainUnseen, AMissingReadingAloneHidesNothing) {
  add_person(kPlace);
  fill_about(kPlace, 0, -1, 0, 1);
  EXPECT_EQ(hand().unseen, Unseen::not_sure);
}

TEST_F(ExplainUnseen, WhereTheCameraSeesPastNobodyIsSure) {
  add_person(kPlace);
  EXPECT_EQ(hand().unseen, Unseen::not_sure);
}

TEST_F(ExplainUnseen, WhereNoPlaceIsKnownNobodyIsSure) {
  add_person(Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()), State::none);
  EXPECT_EQ(hand().unseen, Unseen::not_sure);
}

TEST_F(ExplainUnseen, PeopleWithoutPixelsHideNobody) {
  add_person(kPlace);
  add_person(kPlace);
  people_[0].mask = people_[1].mask = {};
  people_[0].labels = people_[1].labels = {};
  fill_about(kPlace, 1500);
  EXPECT_EQ(hand().unseen, Unseen::behind_something);
}

TEST_F(ExplainUnseen, SmoothedJointsHaveTheSameReasons) {
  add_person(kPlace);
  fill_about(kPlace, 1700, 0);
  TrackedFrame tracked = seen_people(people_);
  tracked.people[0].smoothed = tracked.people[0].person.joints;
  explain_unseen(frame_, body_, tracked);
  EXPECT_EQ(tracked.people[0].smoothed[0][kHandPart].unseen, Unseen::behind_person);
  EXPECT_EQ(tracked.people[0].smoothed[0][kHandPart].behind, 0);
  EXPECT_EQ(tracked.people[0].smoothed[0][kChestPart].unseen, Unseen::none);
}

TEST(PictureWithReadings, LeavesOutBlankBordersUpToATenth) {
  DepthImage depth(100, 50, 0);
  for (int v = 2; v < 50; ++v) {
    for (int u = 4; u < 60; ++u) depth(u, v) = 1000;
  }
  const Box box = picture_with_readings(depth);
  EXPECT_EQ(box.u, 4);
  EXPECT_EQ(box.v, 2);
  EXPECT_EQ(box.width, 100 - 4 - 10);
  EXPECT_EQ(box.height, 48);
}

}  // namespace
}  // namespace vesalius
