#include "vesalius/forest/facing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "vesalius/forest/leaf_logits.h"

namespace vesalius {
namespace {

/// Sides of three parts: one on the middle line, a left one, a right one.
const std::vector<std::uint8_t> kSidesOfParts = {0, 1, 2};

/// Returns a picture of 2x1 pixels with two headings. The first pixel is a left part seen from the front or a right one
/// seen from behind, as likely; the second was settled as background.
Posteriors ambiguous() {
  Posteriors p{2, 1, 4, 255, {0, 100, 100, 55, 0, 0, 0, 255}};
  p.settled = Mask(2, 1, 0);
  p.settled(1, 0) = 1;
  p.headings = 2;
  p.turns = {0, 0, 32768, 0, 0, 32767, 9, 9, 9, 9, 9, 9};
  return p;
}

TEST(Facing, FeaturesAreMeansOverThePixelsOfEachPart) {
  FacingEvidence evidence(2, 2);
  const std::uint16_t first[] = {255, 0}, second[] = {51, 204};
  const std::uint16_t turns[] = {0, 0, 49151, 0, 0, 16384}, even[] = {32768, 32767, 0, 0, 0, 0};
  evidence.add(first, turns);  // headings 3/4 and 1/4
  evidence.add(second, even);
  const std::uint16_t nothing[] = {0, 0};
  evidence.add(nothing, even);  // no reading
  const Eigen::VectorXf features = evidence.features();
  ASSERT_EQ(features.size(), 2 * 2 + 2 + 1);
  const double above = 0.5 * (std::log(0.75) - std::log(0.25));  // above the mean of both headings
  EXPECT_NEAR(features[0], above / 1.2, 1e-3);
  EXPECT_NEAR(features[1], -above / 1.2, 1e-3);
  EXPECT_NEAR(features[2], 0.0, 1e-4);
  EXPECT_NEAR(features[4], 0.6, 1e-6);
  EXPECT_NEAR(features[5], 0.4, 1e-6);
  EXPECT_EQ(features[6], 1.F);
}

TEST(Facing, LooksAtThePersonsPixelsThatWereAskedAbout) {
  const Posteriors p = ambiguous();
  Mask person(2, 1, 1);
  const Eigen::VectorXf both = facing_features(p, 3, person, {0, 0, 2, 1});
  person(1, 0) = 0;
  EXPECT_EQ(both, facing_features(p, 3, person, {0, 0, 2, 1})) << "the settled pixel has no headings";
  person(0, 0) = 0;
  Eigen::VectorXf none = facing_features(p, 3, person, {0, 0, 2, 1});
  EXPECT_EQ(none[none.size() - 1], 1.F);
  none[none.size() - 1] = 0.F;
  EXPECT_EQ(none.norm(), 0.F);
}

TEST(Facing, IsASoftmaxOfTheModel) {
  FacingModel model{2, 1, std::vector<float>(8, 0.F)};
  ASSERT_EQ(model.features(), 4U);
  model.weights[0] = 1.F;   // first heading, first feature
  model.weights[7] = 0.5F;  // second heading, constant
  Eigen::VectorXf features(4);
  features << 2.F, 0.F, 0.F, 1.F;
  const Eigen::VectorXf shares = facing(model, features);
  EXPECT_NEAR(shares[0], 1.0 / (1.0 + std::exp(0.5 - 2.0)), 1e-5);
  EXPECT_NEAR(shares.sum(), 1.F, 1e-5F);
  EXPECT_EQ(facing({2, 1, {}}, features), Eigen::VectorXf::Constant(2, 0.5F));
}

TEST(TurnPosteriors, GiveEachSideWhatTheHeadingMakesOfIt) {
  const Posteriors p = ambiguous();
  Posteriors out;
  Eigen::VectorXf front(2), back(2), even(2);
  front << 1.F, 0.F;
  back << 0.F, 1.F;
  even << 0.5F, 0.5F;
  turn_posteriors(p, kSidesOfParts, front, {0, 0, 2, 1}, out);
  EXPECT_NEAR(out.at(0, 0)[1], 200, 1) << "all of the body is the left part";
  EXPECT_EQ(out.at(0, 0)[2], 0);
  EXPECT_EQ(out.at(0, 0)[3], 55) << "the background stays";
  turn_posteriors(p, kSidesOfParts, back, {0, 0, 2, 1}, out);
  EXPECT_EQ(out.at(0, 0)[1], 0);
  EXPECT_NEAR(out.at(0, 0)[2], 200, 1);
  turn_posteriors(p, kSidesOfParts, even, {0, 0, 2, 1}, out);
  EXPECT_NEAR(out.at(0, 0)[1], 100, 1);
  EXPECT_EQ(out.at(1, 0)[3], 255) << "settled pixels are copied";
}

TEST(TurnPosteriors, HaveTheBoxesSize) {
  Posteriors out;
  turn_posteriors(ambiguous(), kSidesOfParts, Eigen::VectorXf::Constant(2, 0.5F), {1, 0, 1, 1}, out);
  EXPECT_EQ(out.width, 1);
  EXPECT_EQ(out.settled.width(), 1);
  EXPECT_EQ(out.at(0, 0)[3], 255);
}

TEST(EstimateYaw, LiesBetweenTheLikeliestHeadings) {
  Eigen::VectorXf facing = Eigen::VectorXf::Zero(8);
  facing[2] = 0.5F;  // turned to the own left
  facing[3] = 0.5F;
  const YawEstimate left = estimate_yaw(facing);
  EXPECT_NEAR(left.yaw_rad, 2.5F * std::numbers::pi_v<float> / 4.F, 1e-5);
  EXPECT_FLOAT_EQ(left.confidence, 1.F);
}

TEST(EstimateYaw, WrapsAroundTheFrontAndCountsOnlyNeighbours) {
  Eigen::VectorXf facing = Eigen::VectorXf::Zero(8);
  facing << 0.4F, 0.1F, 0.F, 0.F, 0.3F, 0.F, 0.F, 0.2F;
  const YawEstimate ahead = estimate_yaw(facing);
  EXPECT_NEAR(ahead.confidence, 0.7F, 1e-6);
  EXPECT_LT(ahead.yaw_rad, 0.F);
  EXPECT_GT(ahead.yaw_rad, -0.3F);
  facing << 0.F, 0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F;
  EXPECT_NEAR(std::abs(estimate_yaw(facing).yaw_rad), std::numbers::pi_v<float>, 1e-5);
}

}  // namespace
}  // namespace vesalius
