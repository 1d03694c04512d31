#include "vesalius/fit/fit_terms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "vesalius/error.h"
#include "vesalius/fit/test_flesh.h"

namespace vesalius {
namespace {

using Eigen::VectorXd;

/// What is known before anything is seen: the population's shapes.
FitData data_of_nobody() {
  FitData data;
  data.expected.shape = VectorXd::Zero(builtin_flesh().shapes);
  data.expected.shape_information = Eigen::MatrixXd::Identity(builtin_flesh().shapes, builtin_flesh().shapes);
  return data;
}

/// What is known of a seen body, without its outline.
FitData data_of(const test::SeenBody& seen) {
  FitData data = data_of_nobody();
  data.points = seen.person.points;
  return data;
}

struct Costs {
  double cost;
  VectorXd gradient;  // half of it
};

Costs costs_at(const FitTerms& terms, const FitData& data, const BodyState& state) {
  std::vector<PlacedBone> placed;
  NormalEquations equations(builtin_flesh());
  terms.evaluate_points(data, state, {}, placed, equations);
  return {equations.cost(), equations.gradient()};
}

void expect_true_gradient(const FitTerms& terms, const FitData& data, const BodyState& state) {
  constexpr double kStep = 1e-6;
  const Costs here = costs_at(terms, data, state);
  const auto size = static_cast<Eigen::Index>(here.gradient.size());
  for (Eigen::Index i = 0; i < size; ++i) {
    const auto cost_after = [&](double by) {
      return costs_at(terms, data, moved(state, by * VectorXd::Unit(size, i))).cost;
    };
    const double numeric = 0.5 * (cost_after(kStep) - cost_after(-kStep)) / (2.0 * kStep);
    EXPECT_NEAR(here.gradient[i], numeric, 1e-4 * (1.0 + std::abs(numeric))) << "unknown " << i;
  }
}

TEST(FitTerms, PriorsAndLimitsHaveTheGradientOfTheirCost) {
  const FitOptions options;
  const FitTerms terms(builtin_flesh(), paper_body(), options);
  FitData data;
  data.expected.shape = VectorXd::LinSpaced(builtin_flesh().shapes, -1.0, 1.0);
  const Eigen::MatrixXd root = Eigen::MatrixXd::Identity(builtin_flesh().shapes, builtin_flesh().shapes).array() + 0.3;
  data.expected.shape_information = root.transpose() * root;
  // The first lies within the joints' ranges, mostly; the second far beyond them.
  for (const double spread : {0.1, 0.9}) {
    SCOPED_TRACE(spread);
    expect_true_gradient(terms, data, test::random_state(7, spread));
  }
}

TEST(FitTerms, TheExpectedPoseHasTheGradientOfItsCost) {
  const FitOptions options;
  const FitTerms terms(builtin_flesh(), paper_body(), options);
  FitData data = data_of_nobody();
  data.expected.pose = test::usual_state(0.7);
  data.expected.loosened = 1.5;
  BodyState state = test::random_state(8, 0.2);
  state.root += Eigen::Vector3d(0.01, -0.03, 0.05);
  expect_true_gradient(terms, data, state);
}

TEST(FitTerms, MiddlesOfPartsHaveTheGradientOfTheirCost) {
  const FitOptions options;
  const FitTerms terms(builtin_flesh(), paper_body(), options);
  FitData data = data_of_nobody();
  BodyState state = test::random_state(10, 0.2);
  state.shape = VectorXd::LinSpaced(builtin_flesh().shapes, -1.0, 1.0);
  // Beside somebody's middle: near to some parts, far from others.
  const Eigen::Vector3f middle = state.root.cast<float>() + Eigen::Vector3f(0.1F, -0.1F, 0.05F);
  data.middles.assign(paper_body().parts.size(), KnownMiddle{middle, 0.1});
  expect_true_gradient(terms, data, state);
}

TEST(FitTerms, WhoWalksBackwardsCosts) {
  FitOptions options;
  options.walk_cost = 50.F;
  const FitTerms terms(builtin_flesh(), paper_body(), options);
  const BodyState state = test::usual_state(0.0);  // faces the camera: its front is -z, its left x
  const auto cost_at = [&](double x, double y, double z) {
    ExpectedBody expected;
    expected.velocity = {x, y, z};
    return terms.walk_cost(expected, state);
  };
  EXPECT_EQ(cost_at(0.0, 0.0, 0.0), 0.0);
  EXPECT_EQ(cost_at(0.0, 0.0, -1.5), 0.0);
  EXPECT_EQ(cost_at(1.5, 0.0, -0.1), 0.0) << "sideways";
  EXPECT_EQ(cost_at(0.0, 0.0, 0.3), 0.0) << "too slow for a walk";
  EXPECT_NEAR(cost_at(0.0, 0.0, 0.55), 25.0, 1e-9);
  EXPECT_NEAR(cost_at(0.0, 0.0, 0.8), 50.0, 1e-9);
  EXPECT_NEAR(cost_at(0.0, 0.0, 2.0), 50.0, 1e-9);
  EXPECT_NEAR(cost_at(0.8, 0.0, 0.6), 30.0, 1e-9);
  EXPECT_NEAR(cost_at(0.0, 0.4, 0.8), 25.0, 1e-9) << "down as well as back";
  EXPECT_EQ(cost_at(0.0, 1.0, 1.0), 0.0) << "sits down";
}

TEST(FitTerms, WhoLeansFarBackDoesNotWalk) {
  const FitOptions options;
  const FitTerms terms(builtin_flesh(), paper_body(), options);
  ExpectedBody expected;
  expected.velocity = {0.0, 0.0, 1.0};
  expected.ground = Ground{-Eigen::Vector3d::UnitY(), 1.0};
  BodyState state = test::usual_state(0.0);
  EXPECT_NEAR(terms.walk_cost(expected, state), static_cast<double>(options.walk_cost), 1e-6);
  state.local[0] = Eigen::AngleAxisd(-0.7, Eigen::Vector3d::UnitX()) * state.local[0];
  EXPECT_EQ(terms.walk_cost(expected, state), 0.0);
}

TEST(FitTerms, TheGroundHasTheGradientOfItsCost) {
  FitOptions options;
  const FitTerms terms(builtin_flesh(), paper_body(), options);
  FitData data = data_of_nobody();
  const BodyState state = test::random_state(9, 0.2);
  const double without = costs_at(terms, data, state).cost;
  // Knee-deep in the ground, and the feet just above it; the ground is not level with the picture.
  double lowest = 1e9;
  const Eigen::Vector3d up = Eigen::Vector3d(0.1, -0.95, -0.2).normalized();
  for (const PlacedBone& bone : place_bones(builtin_flesh(), state)) lowest = std::min(lowest, up.dot(bone.tail));
  for (const double deep_m : {0.3, -0.12}) {
    SCOPED_TRACE(deep_m);
    data.expected.ground = Ground{up, -lowest - deep_m};
    EXPECT_GT(costs_at(terms, data, state).cost, without + 0.5);
    expect_true_gradient(terms, data, state);
  }
  // Somebody high above it is left alone, but for what a foot off the ground costs at most.
  data.expected.ground = Ground{up, -lowest + 5.0};
  EXPECT_NEAR(costs_at(terms, data, state).cost, without + 9.0, 0.1);
}

TEST(FitTerms, BeyondAJointsRangeAndOffTheExpectedPlaceCosts) {
  const FitOptions options;
  const FitTerms terms(builtin_flesh(), paper_body(), options);
  FitData data = data_of_nobody();
  const BodyState usual = test::usual_state(0.0);
  const double cost = costs_at(terms, data, usual).cost;
  BodyState bent = usual;
  bent.local[builtin_flesh().find_bone("l_shin")] = exp_rotation({-1.5, 0.0, 0.0});  // a knee bent forward
  EXPECT_GT(costs_at(terms, data, bent).cost, cost + 50.0);
  // A shape one deviation off costs 1, a root one deviation off as well.
  BodyState other = usual;
  other.shape[2] = 1.0;
  EXPECT_NEAR(costs_at(terms, data, other).cost, cost + 1.0, 1e-6);
  data.expected.pose = usual;
  BodyState beside = usual;
  beside.root.x() += static_cast<double>(options.follow_m);
  EXPECT_NEAR(costs_at(terms, data, beside).cost, cost + 1.0, 1e-6);
}

TEST(FitTerms, PartsOfTwoBonesLieWhereTheyMeet) {
  const FitOptions options;
  const FitTerms terms(builtin_flesh(), paper_body(), options);
  BodyState state = test::usual_state(0.0);
  test::turn(state, "l_forearm", {0.0, -1.5, 0.0});
  const std::vector<PlacedBone> placed = place_bones(builtin_flesh(), state);
  const auto middle_of = [&](const char* part) { return terms.place_of(paper_body().find_part(part), placed).middle; };
  for (const auto& [part, bone] : {std::pair{"l_elbow", "l_forearm"}, {"r_elbow", "r_forearm"}, {"r_knee", "r_shin"}}) {
    EXPECT_LT((middle_of(part) - placed[builtin_flesh().find_bone(bone)].head).norm(), 0.012) << part;
  }
  // Halves of the trunk lie on both sides of its line, the upper ones higher.
  const Eigen::Vector3d left = middle_of("l_chest"), right = middle_of("r_chest"), hips = middle_of("l_hips");
  const PlacedBone& chest = placed[builtin_flesh().find_bone("chest")];
  EXPECT_NEAR((left + right - 2.0 * chest.head).dot(chest.global.col(0)), 0.0, 1e-6);
  EXPECT_GT((left - right).dot(chest.global.col(0)), 0.12);
  EXPECT_GT((left - hips).dot(chest.global.col(1)), 0.25);
}

TEST(FitTerms, APartMayBeTheEndOfABone) {
  BodyModel body = paper_body();
  const int hand = body.find_part("l_hand");
  const auto rule = std::ranges::find(body.surface, hand, &SurfaceRule::part);
  ASSERT_NE(rule, body.surface.end());
  rule->from = 0.95F;  // beyond the last station of its flesh
  const PartSurface surface(body, builtin_flesh());
  const PartSurface::Middle& middle = surface.middle_of_part[hand];
  ASSERT_EQ(middle.bone, builtin_flesh().find_bone("l_hand"));
  EXPECT_GT(middle.along, 0.7);
  EXPECT_LT(middle.along, 1.0);
}

TEST(FitTerms, PointsBelongToTheStretchOfTheirLabel) {
  const FitOptions options;
  const FitTerms terms(builtin_flesh(), paper_body(), options);
  const test::SeenBody seen = test::see(test::usual_state(0.3));
  const FitData data = data_of(seen);
  ASSERT_GT(data.points.size(), 150U);
  const std::vector<FitTerms::Assigned> assigned = terms.assign(data, seen.truth);
  ASSERT_EQ(assigned.size(), data.points.size());
  for (std::size_t i = 0; i < assigned.size(); ++i) {
    const auto& own = terms.surface().of_part[data.points[i].part.front()];
    EXPECT_TRUE(std::ranges::any_of(own, [&](const PartSurface::Stretch& stretch) {
      const PartSurface::Stretch& of = assigned[i].stretch;
      return stretch.bone == of.bone && stretch.from == of.from && stretch.to == of.to && stretch.side == of.side;
    })) << paper_body().parts[data.points[i].part.front()].name;
    EXPECT_EQ(assigned[i].label_cost, 0.0);
  }
  // Nearly all points lie on the flesh of the bones that they were drawn from.
  int supported = 0;
  for (const FitTerms::Support& support : terms.support(data, seen.truth, assigned)) {
    supported += support.on;
    EXPECT_LE(support.on, support.points);
    EXPECT_LT(support.misfit, 1.0) << "points of the flesh itself";
  }
  EXPECT_GT(supported, static_cast<int>(0.95 * static_cast<double>(assigned.size())));
}

TEST(FitTerms, ALabelOfTheWrongSideCosts) {
  const FitOptions options;
  const FitTerms terms(builtin_flesh(), paper_body(), options);
  const BodyState state = test::usual_state(0.0);
  const test::SeenBody seen = test::see(state);
  FitData data = data_of(seen);
  const auto cost_of = [&] {
    std::vector<PlacedBone> placed;
    NormalEquations equations(builtin_flesh());
    terms.evaluate_points(data, state, terms.assign(data, seen.truth), placed, equations);
    return equations.cost();
  };
  const double right = cost_of();
  int swapped = 0;
  for (PersonPoint& point : data.points) {
    const BodyPart& part = paper_body().parts[point.part.front()];
    if (!part.name.ends_with("_hand") && !part.name.ends_with("_leg")) continue;
    point.part.front() = static_cast<std::uint8_t>(part.mirror);
    ++swapped;
  }
  ASSERT_GT(swapped, 20);
  EXPECT_NEAR(cost_of(), right + swapped * static_cast<double>(kPointWeight * kMirrorCost), 1e-3);
  for (const FitTerms::Assigned& assigned : terms.assign(data, seen.truth)) {
    EXPECT_TRUE(assigned.label_cost == 0.0 || assigned.label_cost == static_cast<double>(kMirrorCost));
  }
}

TEST(FitTerms, ALessProbableLabelCostsByItsLogarithm) {
  const FitOptions options;
  const FitTerms terms(builtin_flesh(), paper_body(), options);
  const test::SeenBody seen = test::see(test::usual_state(0.0));
  FitData data = data_of(seen);
  const auto hand = static_cast<std::uint8_t>(paper_body().find_part("l_hand"));
  const auto foot = static_cast<std::uint8_t>(paper_body().find_part("r_foot"));
  const auto point = std::ranges::find_if(data.points, [&](const PersonPoint& p) { return p.part.front() == hand; });
  ASSERT_NE(point, data.points.end());
  data.points = {*point};
  data.points.front().part = {foot, hand, kBackground};
  data.points.front().share = {0.6F, 0.4F, 0.F};
  const FitTerms::Assigned assigned = terms.assign(data, seen.truth).front();
  EXPECT_EQ(assigned.stretch.bone, builtin_flesh().find_bone("l_hand")) << "the place outweighs the label";
  EXPECT_NEAR(assigned.label_cost, -2.0 * std::log(0.4), 1e-6);
}

}  // namespace
}  // namespace vesalius
