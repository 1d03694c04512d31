#include "vesalius/fit/body_history.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "vesalius/fit/flesh_sections.h"
#include "vesalius/fit/test_flesh.h"

namespace vesalius {
namespace {

/// A person two standard deviations off the usual shape, with arms and legs that swing.
std::vector<test::SeenBody> frames_of_tall_person() {
  std::vector<test::SeenBody> frames;
  for (int i = 0; i < 5; ++i) {
    BodyState state = test::usual_state(0.2 * i - 0.4);
    state.shape[0] = 2.0;
    state.root.z() = 2.9;
    test::turn(state, "l_thigh", {0.1 * i - 0.2, 0.0, 0.0});
    test::turn(state, "r_thigh", {0.2 - 0.1 * i, 0.0, 0.0});
    frames.push_back(test::see(state));
  }
  return frames;
}

/// Returns the person with points that are off by a camera's noise.
Person noisy(const Person& person, Random& random) {
  Person out = person;
  for (PersonPoint& point : out.points) {
    point.at *= 1.F + static_cast<float>(random.normal(0.0, 0.01)) / point.at.norm();
  }
  return out;
}

double length_m(const FleshModel& flesh, const std::vector<PlacedBone>& placed, const char* bone) {
  const PlacedBone& at = placed[flesh.find_bone(bone)];
  return (at.tail - at.head).norm();
}

TEST(BodyHistory, LearnsThePersonsOwnLengths) {
  const FleshModel& flesh = builtin_flesh();
  const BodyFitter fitter(paper_body());
  const std::vector<test::SeenBody> frames = frames_of_tall_person();
  BodyHistory history;
  EXPECT_FALSE(history.stature_m());
  Random random(11);
  std::optional<FittedBody> body;
  for (int i = 0; i < 30; ++i) {
    const int at = i % 8;  // there and back
    const test::SeenBody& seen = frames[at < 5 ? at : 8 - at];
    body = history.fit(fitter, seen.frame, noisy(seen.person, random), i / 30.0);
    ASSERT_TRUE(body) << i;
    EXPECT_EQ(history.size().has_value(), i + 1 >= BodyHistory::kSettledFrames);
  }
  EXPECT_EQ(history.frames(), 30);
  ASSERT_TRUE(history.stature_m());
  EXPECT_EQ(*history.stature_m(), body->stature_m);
  for (const char* bone : {"l_upper_arm", "r_upper_arm", "l_forearm", "l_thigh", "r_thigh", "l_shin", "r_shin"}) {
    const double truth = length_m(flesh, frames[0].truth, bone);
    EXPECT_NEAR(body->bones[flesh.find_bone(bone)].length_m, truth, 0.05 * truth) << bone;
  }
  Eigen::VectorXd shape = Eigen::VectorXd::Zero(flesh.shapes);
  const double usual = stature(flesh, shape);
  shape[0] = 2.0;
  const double truth = stature(flesh, shape);
  ASSERT_GT(truth, 1.05 * usual) << "the test asks for something";
  EXPECT_NEAR(*history.stature_m(), truth, 0.03 * truth);
  EXPECT_NEAR(*history.size(), truth / usual, 0.03);
}

TEST(BodyHistory, ABodyThatLostItsPersonBeginsAnew) {
  const BodyFitter fitter(paper_body());
  // The same place, but the back turned and an arm raised: nobody gets there in a thirtieth of a second.
  BodyState turned = test::usual_state(3.0);
  test::turn(turned, "l_upper_arm", {0.0, 0.0, 1.8});
  turned.root.x() += 0.25;
  const test::SeenBody before = test::see(test::usual_state(0.0)), after = test::see(turned);
  BodyHistory history;
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(history.fit(fitter, before.frame, before.person, i / 30.0));
  const float stature = *history.stature_m();
  std::optional<FittedBody> body;
  for (int i = 5; i < 15; ++i) {
    body = history.fit(fitter, after.frame, after.person, i / 30.0);
    ASSERT_TRUE(body);
  }
  for (std::size_t b = 0; b < body->bones.size(); ++b) {
    EXPECT_LT((body->bones[b].head.cast<double>() - after.truth[b].head).norm(), 0.1) << fitter.flesh().bones[b].name;
  }
  EXPECT_NEAR(body->stature_m, stature, 0.05F) << "bad fits teach nothing about the person";
}

TEST(BodyHistory, WhoBeginsAnewIsNotHeldToTheShapeOfAWrongBody) {
  const BodyFitter fitter(paper_body());
  BodyState small = test::usual_state(0.0);
  small.shape[0] = -2.0;
  BodyState tall = test::usual_state(3.0);
  tall.shape[0] = 2.0;
  tall.root += Eigen::Vector3d(0.25, 0.0, 0.4);
  const test::SeenBody before = test::see(small), after = test::see(tall);
  BodyHistory history;
  for (int i = 0; i < 40; ++i) ASSERT_TRUE(history.fit(fitter, before.frame, before.person, i / 30.0));
  for (int i = 40; i < 52; ++i) ASSERT_TRUE(history.fit(fitter, after.frame, after.person, i / 30.0));
  const double truth = stature(fitter.flesh(), tall.shape);
  EXPECT_NEAR(*history.stature_m(), truth, 0.04 * truth);
}

TEST(BodyHistory, WhoWalksBackwardsIsTurnedAround) {
  const BodyFitter fitter(paper_body());
  const test::SeenBody seen = test::see(test::usual_state(0.0));
  // At first all labels have the wrong side, so that the body turns its back; then they tell nothing of sides.
  test::SeenBody wrong = seen, unsure = seen;
  for (PersonPoint& point : wrong.person.points) test::mirror_label(point);
  for (std::size_t i = 0; i < unsure.person.points.size(); i += 2) test::mirror_label(unsure.person.points[i]);
  const auto towards_camera = [&](const Eigen::Vector3d& velocity) {
    BodyHistory history;
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(history.fit(fitter, wrong.frame, wrong.person, i / 30.0));
    for (int i = 3; i < 8; ++i) {
      EXPECT_TRUE(history.fit(fitter, unsure.frame, unsure.person, i / 30.0, {}, velocity));
    }
    const std::optional<BodyState> state = history.expected_state(fitter.flesh(), 7.0 / 30.0);
    return state ? -state->local[0].toRotationMatrix()(2, 2) : 0.0;
  };
  EXPECT_LT(towards_camera(Eigen::Vector3d::Zero()), -0.7);
  EXPECT_LT(towards_camera({0.0, 0.0, 1.0}), -0.7);
  EXPECT_LT(towards_camera({0.0, 0.0, -0.2}), -0.7) << "slow: it may be the noise of somebody who stands";
  EXPECT_GT(towards_camera({0.0, 0.0, -1.0}), 0.7);
}

TEST(BodyHistory, TheFloorStopsWhoeverFalls) {
  const BodyFitter fitter(paper_body());
  const auto lowest_y = [&](const BodyState& state) {
    float lowest = -std::numeric_limits<float>::infinity();
    for (const Capsule& flesh : flesh_capsules(fitter.flesh(), state)) {
      lowest = std::max({lowest, flesh.from.y() + flesh.from_radius, flesh.to.y() + flesh.to_radius});
    }
    return double(lowest);
  };
  // 1.5 m a second downwards, and 12 cm over the floor when last seen.
  std::vector<BodyState> states(6, test::usual_state(0.4));
  for (int i = 0; i < 6; ++i) states[i].root.y() += 0.05 * i;
  const Ground floor{{0.0, -1.0, 0.0}, lowest_y(states.back()) + 0.12};
  const auto lowest_later = [&](const std::optional<Ground>& ground, double later_s) {
    BodyHistory history;
    for (int i = 0; i < 6; ++i) {
      const test::SeenBody seen = test::see(states[i]);
      EXPECT_TRUE(history.fit(fitter, seen.frame, seen.person, i / 30.0, ground));
    }
    const std::optional<BodyState> state = history.expected_state(fitter.flesh(), 5.0 / 30.0 + later_s);
    return state ? floor.height_m - lowest_y(*state) : std::numeric_limits<double>::quiet_NaN();
  };
  EXPECT_LT(lowest_later({}, 0.3), -0.1) << "nobody knows of a floor";
  EXPECT_NEAR(lowest_later(floor, 0.3), 0.0, 1e-4);
  EXPECT_NEAR(lowest_later(floor, 1.0 / 30.0), lowest_later({}, 1.0 / 30.0), 0.03) << "not there yet";
}

TEST(BodyHistory, BadTimesForgetThePoseAndNeverFail) {
  const BodyFitter fitter(paper_body());
  const BodyState state = test::usual_state(0.0);
  BodyState elsewhere = test::usual_state(0.5);
  elsewhere.root += Eigen::Vector3d(0.3, 0.0, 0.6);
  const test::SeenBody here = test::see(state), there = test::see(elsewhere);
  for (const double time_s : {-5.0, 9.9, 11.0, 3.6e4, 1e300, std::numeric_limits<double>::infinity(),
                              std::numeric_limits<double>::quiet_NaN()}) {
    SCOPED_TRACE(time_s);
    BodyHistory history;
    ASSERT_TRUE(history.fit(fitter, here.frame, here.person, 10.0 - 1.0 / 30.0));
    ASSERT_TRUE(history.fit(fitter, here.frame, here.person, 10.0));
    BodyHistory forgetful = history;
    forgetful.forget_pose();
    // Somebody who is elsewhere at such a time is fitted as if there had been no pose.
    const std::optional<FittedBody> body = history.fit(fitter, there.frame, there.person, time_s);
    const std::optional<FittedBody> expected = forgetful.fit(fitter, there.frame, there.person, 10.0);
    ASSERT_TRUE(body && expected);
    for (std::size_t b = 0; b < body->bones.size(); ++b) EXPECT_EQ(body->bones[b].head, expected->bones[b].head);
    // The next frame in time follows again.
    const double next_s = std::isfinite(time_s) ? time_s + 1.0 / 30.0 : 10.1;
    const std::optional<FittedBody> after = history.fit(fitter, there.frame, there.person, next_s);
    ASSERT_TRUE(after);
    for (const FittedBone& bone : after->bones) EXPECT_TRUE(bone.head.allFinite());
  }
}

TEST(BodyHistory, TimeThatStandsStillIsBorne) {
  const BodyFitter fitter(paper_body());
  const test::SeenBody seen = test::see(test::usual_state(0.0));
  BodyHistory history;
  for (int i = 0; i < 6; ++i) {
    const std::optional<FittedBody> body = history.fit(fitter, seen.frame, seen.person, 2.0);
    ASSERT_TRUE(body);
    for (std::size_t b = 0; b < body->bones.size(); ++b) {
      EXPECT_LT((body->bones[b].head.cast<double>() - seen.truth[b].head).norm(), 0.1);
    }
  }
}

TEST(BodyHistory, LearnsNothingFromTooFewPoints) {
  const BodyFitter fitter(paper_body());
  test::SeenBody seen = test::see(test::usual_state(0.0));
  seen.person.points.resize(10);
  BodyHistory history;
  EXPECT_FALSE(history.fit(fitter, seen.frame, seen.person, 0.0));
  EXPECT_FALSE(history.stature_m());
  EXPECT_EQ(history.frames(), 0);
}

}  // namespace
}  // namespace vesalius
