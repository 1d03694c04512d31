#include "vesalius/fit/fit_body.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "vesalius/base/test_threads.h"
#include "vesalius/error.h"
#include "vesalius/fit/test_flesh.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

using std::numbers::pi;

/// People who stand, walk, sit and stretch their arms, seen from the front, obliquely and from behind.
std::vector<BodyState> poses() {
  std::vector<BodyState> states;
  for (const double yaw : {0.0, 0.6, pi, pi - 0.5}) states.push_back(test::usual_state(yaw));
  BodyState walking = test::usual_state(0.3);
  test::turn(walking, "l_thigh", {-0.5, 0.0, 0.0});
  test::turn(walking, "r_thigh", {0.3, 0.0, 0.0});
  test::turn(walking, "r_shin", {0.5, 0.0, 0.0});
  states.push_back(walking);
  BodyState sitting = test::usual_state(0.4);
  for (const char* bone : {"l_thigh", "r_thigh"}) test::turn(sitting, bone, {-1.4, 0.0, 0.0});
  for (const char* bone : {"l_shin", "r_shin"}) test::turn(sitting, bone, {1.4, 0.0, 0.0});
  states.push_back(sitting);
  for (const double yaw : {0.0, pi}) {
    BodyState wide = test::usual_state(yaw);
    for (const char* bone : {"l_upper_arm", "r_upper_arm", "l_forearm", "r_forearm"}) {
      wide.local[builtin_flesh().find_bone(bone)].setIdentity();
    }
    states.push_back(wide);
  }
  return states;
}

/// Mean distance of the bones' heads from the truth, metres.
double mean_error_m(const FittedBody& body, const std::vector<PlacedBone>& truth) {
  double sum = 0.0;
  for (std::size_t b = 0; b < truth.size(); ++b) sum += (body.bones[b].head.cast<double>() - truth[b].head).norm();
  return sum / static_cast<double>(truth.size());
}

/// Expects each bone of a pair of limbs nearer to its own truth than to the other side's.
void expect_sides(const FittedBody& body, const std::vector<PlacedBone>& truth) {
  const FleshModel& flesh = builtin_flesh();
  for (const char* name : {"l_upper_arm", "l_forearm", "l_thigh", "l_shin", "l_foot"}) {
    const int left = flesh.find_bone(name), right = flesh.bones[left].mirror;
    const auto far = [&](int bone, int from) {
      return (body.bones[bone].head.cast<double>() - truth[from].head).norm();
    };
    EXPECT_LT(far(left, left) + far(right, right), far(left, right) + far(right, left)) << name;
  }
}

/// Puts a box before the lower body.
void hide_from_thighs_down(test::SeenBody& seen) {
  const int top = static_cast<int>(seen.frame.camera.pixel(seen.truth[0].head.cast<float>()).y()) + 8;
  for (int v = top; v < seen.frame.depth.height(); ++v) {
    for (int u = 0; u < seen.frame.depth.width(); ++u) {
      seen.frame.depth(u, v) = 1200;
      seen.person.labels(u, v) = kBackground;
    }
  }
  test::describe(paper_body(), seen.frame, seen.person);
}

bool same_bytes(const FittedBody& a, const FittedBody& b) {
  if (a.bones.size() != b.bones.size() || a.shape != b.shape || a.stature_m != b.stature_m || a.misfit != b.misfit) {
    return false;
  }
  for (std::size_t i = 0; i < a.bones.size(); ++i) {
    const FittedBone &p = a.bones[i], &q = b.bones[i];
    if (p.head != q.head || p.tail != q.tail || p.global.coeffs() != q.global.coeffs() ||
        p.local.coeffs() != q.local.coeffs() || p.covariance != q.covariance || p.confidence != q.confidence ||
        p.tail_confidence != q.tail_confidence || p.support != q.support || p.state != q.state) {
      return false;
    }
  }
  return true;
}

TEST(FitBody, FindsTheBodyThatWasSeen) {
  const BodyFitter fitter(paper_body());
  ASSERT_TRUE(fitter.can_fit());
  const std::vector<BodyState> states = poses();
  for (std::size_t i = 0; i < states.size(); ++i) {
    SCOPED_TRACE(i);
    const test::SeenBody seen = test::see(states[i]);
    const std::optional<BodyFit> fit = fitter.fit(seen.frame, seen.person);
    ASSERT_TRUE(fit);
    EXPECT_LT(mean_error_m(fit->body, seen.truth), 0.03);
    expect_sides(fit->body, seen.truth);
    EXPECT_NEAR(fit->body.stature_m, stature(builtin_flesh(), states[i].shape), 0.1);
    EXPECT_EQ(fit->body.shape.size(), static_cast<std::size_t>(builtin_flesh().shapes));
  }
}

TEST(FitBody, OutputsAgreeWithEachOther) {
  const FleshModel& flesh = builtin_flesh();
  const test::SeenBody seen = test::see(poses()[4]);
  const std::optional<BodyFit> fit = BodyFitter(paper_body()).fit(seen.frame, seen.person);
  ASSERT_TRUE(fit);
  const std::vector<PlacedBone> placed = place_bones(flesh, fit->state);
  for (int b = 0; b < flesh.bone_count(); ++b) {
    const FittedBone& bone = fit->body.bones[b];
    SCOPED_TRACE(flesh.bones[b].name);
    EXPECT_LT((bone.head.cast<double>() - placed[b].head).norm(), 1e-5);
    EXPECT_LT((bone.tail.cast<double>() - placed[b].tail).norm(), 1e-5);
    EXPECT_NEAR(bone.length_m, (bone.tail - bone.head).norm(), 1e-5F);
    const Eigen::Quaternionf up =
        flesh.bones[b].parent < 0 ? Eigen::Quaternionf::Identity() : fit->body.bones[flesh.bones[b].parent].global;
    EXPECT_LT((up * bone.local).angularDistance(bone.global), 1e-3F);
    EXPECT_TRUE(bone.covariance.isApprox(bone.covariance.transpose(), 1e-4F));
    EXPECT_GT(bone.covariance.trace(), 0.F);
    EXPECT_NEAR(bone.of_head.log_sigma, 0.5F * std::log(bone.covariance.trace() / 3.F), 1e-4F);
    EXPECT_EQ(bone.of_head.misfit, fit->body.misfit);
    EXPECT_EQ(bone.confidence, trusted(builtin_trust(), source_of(fit->body, bone), bone.of_head));
    EXPECT_EQ(bone.of_head.unseen_s, 0.F);
    for (const float probability : {bone.confidence, bone.tail_confidence}) {
      EXPECT_GT(probability, 0.F);
      EXPECT_LT(probability, 1.F);
    }
  }
}

TEST(FitBody, HiddenLimbsArePredictedAndLessCertain) {
  const FleshModel& flesh = builtin_flesh();
  test::SeenBody seen = test::see(test::usual_state(0.0));
  hide_from_thighs_down(seen);
  const std::optional<BodyFit> fit = BodyFitter(paper_body()).fit(seen.frame, seen.person);
  ASSERT_TRUE(fit);
  const FittedBone& foot = fit->body.bones[flesh.find_bone("l_foot")];
  const FittedBone& hand = fit->body.bones[flesh.find_bone("l_upper_arm")];
  EXPECT_EQ(foot.state, State::predicted);
  EXPECT_EQ(foot.support, 0);
  EXPECT_EQ(hand.state, State::observed);
  EXPECT_GT(foot.covariance.trace(), 4.F * hand.covariance.trace());
  EXPECT_LT(foot.confidence, hand.confidence);
}

/// Returns votes for where the parts truly are, those of the legs to some centimetres and others to a metre.
std::vector<VotedPart> votes_for_legs(const test::SeenBody& seen) {
  const FitOptions options;
  const FitTerms terms(builtin_flesh(), paper_body(), options);
  std::vector<VotedPart> votes(paper_body().parts.size(), {seen.truth[0].head.cast<float>(), 1.F});
  for (std::size_t part = 0; part < votes.size(); ++part) {
    const std::string& bone = builtin_flesh().bones[terms.surface().middle_of_part[part].bone].name;
    if (!bone.ends_with("thigh") && !bone.ends_with("shin") && !bone.ends_with("foot")) continue;
    votes[part] = {terms.place_of(int(part), seen.truth).middle.cast<float>(), 0.02F};
  }
  return votes;
}

TEST(FitBody, VotesPlaceLimbsThatAreHidden) {
  BodyState astride = test::usual_state(0.4);
  test::turn(astride, "l_thigh", {0.0, 0.0, 0.6});
  test::turn(astride, "r_thigh", {0.0, 0.0, -0.6});
  test::SeenBody seen = test::see(astride);
  hide_from_thighs_down(seen);
  const auto error_m = [&] {
    const std::optional<BodyFit> fit = BodyFitter(paper_body()).fit(seen.frame, seen.person);
    double sum = 0.0;
    for (const char* name : {"l_shin", "r_shin", "l_foot", "r_foot"}) {
      const int bone = builtin_flesh().find_bone(name);
      sum += (fit->body.bones[bone].head.cast<double>() - seen.truth[bone].head).norm();
    }
    return sum / 4.0;
  };
  EXPECT_GT(error_m(), 0.18) << "nothing else tells how somebody stands behind the box";
  seen.person.skeleton.voted = votes_for_legs(seen);
  EXPECT_LT(error_m(), 0.1);
}

TEST(FitBody, HasNoLegsInTheGround) {
  const FleshModel& flesh = builtin_flesh();
  const BodyFitter fitter(paper_body());
  test::SeenBody seen = test::see(test::usual_state(0.2));
  hide_from_thighs_down(seen);
  // Legs that are not seen are those of somebody who stands, unless the ground, here as high as the knees, forbids
  // that.
  const Eigen::Vector3d up = -Eigen::Vector3d::UnitY();
  const Ground ground{up, -up.dot(seen.truth[flesh.find_bone("l_shin")].head)};
  const auto lowest_m = [&](const std::optional<BodyFit>& fit) {
    double lowest = 10.0;
    for (const FittedBone& bone : fit->body.bones)
      lowest = std::min(lowest, ground.height_of(bone.tail.cast<double>()));
    return lowest;
  };
  ExpectedBody expected;
  const std::optional<BodyFit> without = fitter.fit(seen.frame, seen.person, expected);
  expected.ground = ground;
  const std::optional<BodyFit> with = fitter.fit(seen.frame, seen.person, expected);
  ASSERT_TRUE(without && with);
  EXPECT_LT(lowest_m(without), -0.3);
  EXPECT_GT(lowest_m(with), -0.08);
}

TEST(FitBody, BearsWrongSides) {
  const BodyFitter fitter(paper_body());
  const std::vector<BodyState> states = poses();
  for (std::size_t i = 0; i < states.size(); ++i) {
    SCOPED_TRACE(i);
    test::SeenBody seen = test::see(states[i]);
    Random random(10 + i);
    for (PersonPoint& point : seen.person.points) {
      if (random.below(10) == 0) test::mirror_label(point);
    }
    const std::optional<BodyFit> fit = fitter.fit(seen.frame, seen.person);
    ASSERT_TRUE(fit);
    EXPECT_LT(mean_error_m(fit->body, seen.truth), 0.03);
    expect_sides(fit->body, seen.truth);
  }
}

TEST(FitBody, WhoWalksFacesWhereItGoes) {
  const BodyFitter fitter(paper_body());
  for (const double yaw : {0.0, pi}) {
    SCOPED_TRACE(yaw);
    // Labels of which every other has the wrong side do not tell how the body is turned.
    test::SeenBody seen = test::see(test::usual_state(yaw));
    for (std::size_t i = 0; i < seen.person.points.size(); i += 2) test::mirror_label(seen.person.points[i]);
    ExpectedBody expected;
    for (const double speed : {1.2, -1.2}) {
      expected.velocity = {0.1, 0.0, speed};
      const std::optional<BodyFit> fit = fitter.fit(seen.frame, seen.person, expected);
      ASSERT_TRUE(fit);
      const Eigen::Vector3d front = fit->state.local[0].toRotationMatrix().col(2);
      EXPECT_GT(front.dot(expected.velocity.normalized()), 0.7) << speed;
    }
  }
}

TEST(FitBody, TellsWhereTheCameraSeesPastAJoint) {
  const FleshModel& flesh = builtin_flesh();
  test::SeenBody seen = test::see(test::usual_state(0.0));
  const int hand = flesh.find_bone("l_hand");
  const BodyFitter fitter(paper_body());
  const std::optional<BodyFit> whole = fitter.fit(seen.frame, seen.person);
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->body.bones[hand].of_head.free, 0.F);
  // The pose is held as the forearm and the hand vanish: the camera sees the wall where they would be.
  const Eigen::Vector2f at = seen.frame.camera.pixel(seen.truth[hand].head.cast<float>());
  for (int v = 0; v < seen.frame.depth.height(); ++v) {
    for (int u = 0; u < seen.frame.depth.width(); ++u) {
      if ((Eigen::Vector2f(static_cast<float>(u), static_cast<float>(v)) - at).norm() > 18.F) continue;
      seen.frame.depth(u, v) = 4500;
      seen.person.labels(u, v) = kBackground;
    }
  }
  test::describe(paper_body(), seen.frame, seen.person);
  FitOptions options;
  options.outline_weight = 0.F;
  ExpectedBody expected;
  expected.pose = whole->state;
  expected.start = -1;
  const std::optional<BodyFit> fit = BodyFitter(paper_body(), options).fit(seen.frame, seen.person, expected);
  ASSERT_TRUE(fit);
  EXPECT_EQ(fit->body.bones[hand].of_head.free, 1.F);
}

TEST(FitBody, NeedsPointsAndParts) {
  const BodyFitter fitter(paper_body());
  const test::SeenBody seen = test::see(test::usual_state(0.0));
  Person few = seen.person;
  few.points.resize(29);
  EXPECT_FALSE(fitter.fit(seen.frame, few));
  few.points.clear();
  EXPECT_FALSE(fitter.fit(seen.frame, few));
  Person shapeless = seen.person;
  for (SkeletonPart& part : shapeless.skeleton.parts) part.state = State::none;
  EXPECT_FALSE(fitter.fit(seen.frame, shapeless)) << "nothing to start from";
  // The last pose is enough of a start.
  ExpectedBody expected;
  expected.pose = test::usual_state(0.1);
  expected.start = -1;
  const std::optional<BodyFit> fit = fitter.fit(seen.frame, shapeless, expected);
  ASSERT_TRUE(fit);
  EXPECT_LT(mean_error_m(fit->body, seen.truth), 0.03);
}

TEST(FitBody, NeedsSurfaceRules) {
  BodyModel body = paper_body();
  body.surface.clear();
  const BodyFitter fitter(body);
  EXPECT_FALSE(fitter.can_fit());
  const test::SeenBody seen = test::see(test::usual_state(0.0));
  EXPECT_FALSE(fitter.fit(seen.frame, seen.person));
}

TEST(FitBody, RefusesOptionsOutsideTheirRanges) {
  FitOptions options;
  options.surface_m = 0.F;
  EXPECT_THROW(BodyFitter(paper_body(), options), UsageError);
}

TEST(FitBody, HasTheSameBytesForAnyNumberOfThreads) {
  const BodyFitter fitter(paper_body());
  std::vector<test::SeenBody> seen;
  for (const BodyState& state : poses()) seen.push_back(test::see(state));
  std::vector<FittedBody> first;
  for_threads({1, 4}, [&] {
    std::vector<FittedBody> bodies(seen.size());
    parallel_for(static_cast<int>(seen.size()), [&](int i) {
      if (const auto fit = fitter.fit(seen[i].frame, seen[i].person)) bodies[i] = fit->body;
    });
    if (first.empty()) first = bodies;
    for (std::size_t i = 0; i < bodies.size(); ++i) EXPECT_TRUE(same_bytes(bodies[i], first[i])) << i;
  });
}

}  // namespace
}  // namespace vesalius
