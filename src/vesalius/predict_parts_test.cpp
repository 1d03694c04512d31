#include "vesalius/predict_parts.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "vesalius/vote_parts.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;

const Vector3f kUnknown = Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());

BodyModel without_distribution() {
  BodyModel body = paper_body();
  body.distribution = {};
  return body;
}

Skeleton whole_skeleton() {
  Skeleton s;
  for (int i = 0; i < paper_body().part_count(); ++i) {
    SkeletonPart part;
    part.state = State::observed;
    part.centre = Vector3f(0.1F * static_cast<float>(i), 0.F, 2.F);
    part.confidence = 0.8F;
    s.parts.push_back(part);
  }
  return s;
}

SkeletonPart& part_of(Skeleton& s, const char* name) { return s.parts[paper_body().find_part(name)]; }

TEST(PredictMissingParts, PutsAnElbowBetweenArmAndForearm) {
  Skeleton s = whole_skeleton();
  part_of(s, "l_upper_arm").centre = {0.F, 0.F, 2.F};
  part_of(s, "l_forearm").centre = {0.F, 0.25F, 2.F};
  part_of(s, "l_forearm").confidence = 0.4F;
  part_of(s, "l_elbow") = {};
  predict_missing_parts(without_distribution(), s);
  const SkeletonPart& elbow = part_of(s, "l_elbow");
  EXPECT_EQ(elbow.state, State::predicted);
  EXPECT_NEAR(elbow.centre.y(), 0.25F * 0.196F / 0.331F, 1e-5);  // links of 0.196 and 0.135 m
  EXPECT_FLOAT_EQ(elbow.confidence, 0.2F);
}

TEST(PredictMissingParts, PredictsNoEndsOfLimbs) {
  Skeleton s = whole_skeleton();
  part_of(s, "l_hand") = {};
  part_of(s, "r_elbow") = {};
  part_of(s, "r_forearm") = {};  // the elbow's neighbour is missing too
  predict_missing_parts(without_distribution(), s);
  EXPECT_EQ(part_of(s, "l_hand").state, State::none);
  EXPECT_EQ(part_of(s, "r_elbow").state, State::none);
}

/// Five parts on a cross; one factor moves the fifth, and less the fourth, along z.
PartDistribution cross() {
  PartDistribution d;
  d.factors = 1;
  d.noise_m = 0.01F;
  d.confidence = {.bias = -4.F, .slope = -2.F};
  const std::array<std::array<float, 3>, 5> means{
      {{0, -0.5F, 0}, {0, 0.5F, 0}, {0.3F, 0, 0}, {-0.3F, 0, 0}, {0, 0, 0.4F}}};
  for (std::size_t p = 0; p < means.size(); ++p) {
    PartDistribution::Part part;
    part.mean_m = means[p];
    part.factors_m = {{{0.F}, {0.F}, {p == 4 ? 0.2F : p == 3 ? 0.1F : 0.F}}};
    part.residual_m = 0.02F;
    d.parts.push_back(part);
  }
  return d;
}

/// Returns the cross's parts where the factor has this value, turned and shifted.
std::vector<Vector3f> placed(float factor) {
  const PartDistribution d = cross();
  const Eigen::AngleAxisf turn(2.F, Vector3f(1.F, 2.F, -1.F).normalized());
  std::vector<Vector3f> places;
  for (const PartDistribution::Part& part : d.parts) {
    const Vector3f place(part.mean_m[0], part.mean_m[1], part.mean_m[2] + factor * part.factors_m[2][0]);
    places.emplace_back(turn * place + Vector3f(0.3F, -0.2F, 2.F));
  }
  return places;
}

TEST(PredictParts, FindsAPartOfABodyTurnedAnyWay) {
  std::vector<Vector3f> seen = placed(0.F);
  const Vector3f hidden = seen[2];
  seen[2] = kUnknown;
  const std::vector<PredictedPart> predicted = predict_parts(cross(), seen, {});
  ASSERT_EQ(predicted.size(), 5U);
  EXPECT_LT((predicted[2].centre - hidden).norm(), 0.01F);
  EXPECT_LT((predicted[0].centre - seen[0]).norm(), 0.01F);
}

TEST(PredictParts, FollowsWhatMovesWithIt) {
  std::vector<Vector3f> seen = placed(1.F);
  const Vector3f hidden = seen[4];
  seen[4] = kUnknown;
  EXPECT_LT((predict_parts(cross(), seen, {})[4].centre - hidden).norm(), 0.08F);
  EXPECT_GT((placed(0.F)[4] - hidden).norm(), 0.19F);
}

TEST(PredictParts, IsLessSureOfWhatMovesFreely) {
  std::vector<Vector3f> seen = placed(0.F);
  seen[2] = seen[4] = kUnknown;
  const std::vector<PredictedPart> with = predict_parts(cross(), seen, {});
  EXPECT_GT(with[4].sigma_m, with[2].sigma_m);
  seen[3] = kUnknown;                                     // it moves with the fifth
  EXPECT_TRUE(predict_parts(cross(), seen, {}).empty());  // two are known
  seen[2] = placed(0.F)[2];
  EXPECT_GT(predict_parts(cross(), seen, {})[4].sigma_m, with[4].sigma_m);
  EXPECT_GT(predicted_confidence(cross().confidence, 0.05F), predicted_confidence(cross().confidence, 0.1F));
}

/// Returns a skeleton all of whose parts are observed at these places.
Skeleton seen_at(const std::vector<Vector3f>& places) {
  Skeleton s;
  for (const Vector3f& place : places) {
    SkeletonPart part;
    part.state = State::observed;
    part.centre = place;
    s.parts.push_back(part);
  }
  return s;
}

TEST(PredictMissingParts, GivesThoseAPlaceThatAreSureEnough) {
  BodyModel body;
  body.parts.resize(5);
  body.distribution = cross();
  Skeleton s = seen_at(placed(0.F));
  const Vector3f hidden = s.parts[2].centre;
  s.parts[2] = s.parts[4] = {};
  predict_missing_parts(body, s);
  EXPECT_EQ(s.parts[2].state, State::predicted);
  EXPECT_LT((s.parts[2].centre - hidden).norm(), 0.02F);
  EXPECT_GT(s.parts[2].confidence, kLeastPredictedConfidence);
  body.distribution.confidence.bias = -20.F;
  s.parts[2] = {};
  predict_missing_parts(body, s);
  EXPECT_EQ(s.parts[2].state, State::none);
}

/// Returns votes for the places of the cross, whose parts lie 5 cm behind their surfaces.
std::vector<VotedPart> votes_for(const std::vector<Vector3f>& places, float spread_m) {
  std::vector<VotedPart> votes;
  for (const Vector3f& place : places) votes.push_back({place + 0.05F * place.normalized(), spread_m});
  return votes;
}

PartDistribution voted_cross() {
  PartDistribution d = cross();
  for (PartDistribution::Part& part : d.parts) part.depth_m = 0.05F;
  d.voted_confidence = {.bias = -5.F, .slope = -2.F};
  return d;
}

TEST(PredictParts, GoesWhereVotesSayThatAHiddenPartIs) {
  const std::vector<Vector3f> places = placed(2.F);  // the fifth is 40 cm from where it mostly is
  std::vector<Vector3f> seen = places;
  seen[3] = seen[4] = kUnknown;  // none that moves with it is seen
  const auto off = [&](const std::vector<VotedPart>& votes) {
    return (predict_parts(voted_cross(), seen, votes)[4].centre - places[4]).norm();
  };
  EXPECT_GT(off({}), 0.3F);
  EXPECT_LT(off(votes_for(places, 0.F)), 0.12F);
  EXPECT_GT(off(votes_for(places, 0.3F)), off(votes_for(places, 0.05F)));  // votes that differ count less
  const auto sigma = [&](float spread_m) {
    return predict_parts(voted_cross(), seen, votes_for(places, spread_m))[4].sigma_m;
  };
  EXPECT_LT(sigma(0.F), sigma(0.1F));
  EXPECT_LT(sigma(0.1F), predict_parts(voted_cross(), seen, {})[4].sigma_m);
}

TEST(PredictParts, BelievesWhatIsSeenMoreThanVotes) {
  const std::vector<Vector3f> seen = placed(0.F);
  std::vector<Vector3f> wrong = seen;
  for (Vector3f& place : wrong) place.x() += 1.F;
  const std::vector<PredictedPart> with = predict_parts(voted_cross(), seen, votes_for(wrong, 0.F));
  for (std::size_t p = 0; p < seen.size(); ++p) EXPECT_LT((with[p].centre - seen[p]).norm(), 0.01F) << p;
}

TEST(DrawnToVotes, LiesBetweenWhatIsSeenAndVotesByTheirVariances) {
  PartDistribution d = voted_cross();
  Skeleton s = seen_at(placed(0.F));
  s.parts[3].state = State::predicted;
  std::vector<Vector3f> elsewhere = placed(0.F);
  for (Vector3f& place : elsewhere) place += Vector3f(0.F, 0.2F, 0.F);
  s.voted = votes_for(elsewhere, 0.F);
  const auto sigma_m = static_cast<float>(voted_sigma_m(s.voted[0]));
  d.parts[1].observed_m = d.parts[3].observed_m = sigma_m;
  d.parts[2].observed_m = 2.F * sigma_m;
  const auto moved = [&](std::size_t p) { return (drawn_to_votes(d, s).parts[p].centre - s.parts[p].centre).norm(); };
  EXPECT_FLOAT_EQ(moved(0), 0.F);  // as if it were exact
  EXPECT_NEAR(moved(1), 0.1F, 1e-4F);
  EXPECT_NEAR(moved(2), 0.16F, 1e-4F);
  EXPECT_FLOAT_EQ(moved(3), 0.F);  // votes are in what is predicted
  d.voted_confidence.reset();
  EXPECT_FLOAT_EQ(moved(1), 0.F);
}

TEST(KnownMiddles, AreSurerOfWhatIsSeen) {
  PartDistribution d = voted_cross();
  for (PartDistribution::Part& part : d.parts) part.observed_m = 10.F;  // votes say where it is
  d.parts[1].observed_m = 0.F;
  Skeleton s = seen_at(placed(0.F));
  s.parts[3] = {};
  EXPECT_TRUE(known_middles(d, s).empty());
  s.voted = votes_for(placed(0.F), 0.1F);
  const std::vector<KnownMiddle> middles = known_middles(d, s);
  ASSERT_EQ(middles.size(), 5U);
  for (std::size_t p = 0; p < 5; ++p) EXPECT_LT((middles[p].at - s.voted[p].centre).norm(), 1e-5F) << p;
  const double sigma_m = voted_sigma_m(s.voted[3]);
  EXPECT_DOUBLE_EQ(middles[3].sigma_m, sigma_m);
  EXPECT_NEAR(middles[2].sigma_m, 0.5 * sigma_m, 1e-3);
  EXPECT_FLOAT_EQ(static_cast<float>(middles[1].sigma_m), d.noise_m);  // nothing that is seen is surer
}

TEST(PredictMissingParts, TakesVotesWhereTheBodySaysHowSureTheyAre) {
  BodyModel body;
  body.parts.resize(5);
  body.distribution = voted_cross();
  Skeleton s;
  s.parts.resize(5);
  s.voted = votes_for(placed(0.F), 0.01F);
  Skeleton without = s;
  predict_missing_parts(body, s);  // nothing is seen
  for (std::size_t p = 0; p < 5; ++p) {
    ASSERT_EQ(s.parts[p].state, State::predicted) << p;
    EXPECT_LT((s.parts[p].centre - placed(0.F)[p]).norm(), 0.02F) << p;
  }
  body.distribution.voted_confidence.reset();
  predict_missing_parts(body, without);
  for (const SkeletonPart& part : without.parts) EXPECT_EQ(part.state, State::none);
}

TEST(PredictMissingParts, GoesByWhatIsSeenAndVotesTogether) {
  BodyModel body;
  body.parts.resize(5);
  body.distribution = voted_cross();
  Skeleton s = seen_at(placed(0.F));
  for (SkeletonPart& part : s.parts) part.centre.y() += 0.1F;
  s.parts[4] = {};
  s.voted = votes_for(placed(0.F), 0.F);
  s.voted[4].spread_m = 1.F;  // nobody knows where the fifth is
  const auto error = [&] {
    Skeleton filled = s;
    predict_missing_parts(body, filled);
    EXPECT_FLOAT_EQ((filled.parts[0].centre - s.parts[0].centre).norm(), 0.F);  // stays what is visible
    return (filled.parts[4].centre - placed(0.F)[4]).norm();
  };
  EXPECT_GT(error(), 0.07F);
  for (PartDistribution::Part& part : body.distribution.parts) part.observed_m = 0.5F;
  EXPECT_LT(error(), 0.03F);
}

TEST(BestRotation, UndoesATurnAndMakesNoMirrorImage) {
  Eigen::Matrix3Xd points(3, 4);
  points << 0, 1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, -1, 2).normalized()).toRotationMatrix();
  const Eigen::Matrix3Xd turned = (turn * points).colwise() + Eigen::Vector3d(1, 2, 3);
  EXPECT_TRUE(best_rotation(points, turned, Eigen::VectorXd::Ones(4)).isApprox(turn, 1e-9));
  Eigen::Matrix3Xd mirrored = points;
  mirrored.row(0) *= -1.0;
  EXPECT_NEAR(best_rotation(points, mirrored, Eigen::VectorXd::Ones(4)).determinant(), 1.0, 1e-9);
}

}  // namespace
}  // namespace vesalius
