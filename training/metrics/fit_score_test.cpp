#include "metrics/fit_score.h"

#include <gmock/gmock.h>

#include <cmath>

#include "vesalius/base/error.h"
#include "vesalius/base/random.h"

namespace vesalius {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

Evidence random_evidence(Random& random) {
  const auto draw = [&] { return static_cast<float>(random.uniform()); };
  Evidence e;
  for (const EvidenceWeight& piece : kEvidenceWeights) e.*piece.evidence = draw();
  return e;
}

/// Returns candidates that are people with the probability of their score.
std::vector<ScoreSample> drawn(const ScoreOptions& truth, int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<ScoreSample> samples;
  for (int i = 0; i < count; ++i) {
    const Evidence e = random_evidence(random);
    samples.push_back({e, random.uniform() < static_cast<double>(person_score(e, truth))});
  }
  return samples;
}

ScoreOptions drawn_weights() {
  ScoreOptions truth;
  truth.likelihood_weight = 4.F;
  truth.explained_weight = 2.F;
  truth.open_weight = 1.F;
  truth.core_weight = 3.F;
  truth.body_weight = 1.F;
  truth.size_weight = 2.F;
  truth.occluded_weight = 3.F;
  truth.near_weight = 1.5F;
  truth.certain_weight = 2.F;
  truth.border_weight = -3.F;
  truth.beside_weight = -2.F;
  truth.resolution_weight = 1.F;
  truth.bias = -7.F;
  return truth;
}

TEST(FitScore, FindsTheWeightsThatMadeTheSamples) {
  const ScoreOptions truth = drawn_weights();
  const ScoreFit fit = fit_score({drawn(truth, 40000, 3)}, {});
  // People and nobodies have different weights, which affects only the bias.
  EXPECT_NEAR(fit.options.likelihood_weight, truth.likelihood_weight, 0.25);
  EXPECT_NEAR(fit.options.explained_weight, truth.explained_weight, 0.25);
  EXPECT_NEAR(fit.options.open_weight, truth.open_weight, 0.25);
  EXPECT_NEAR(fit.options.core_weight, truth.core_weight, 0.25);
  EXPECT_NEAR(fit.options.body_weight, truth.body_weight, 0.25);
  EXPECT_NEAR(fit.options.size_weight, truth.size_weight, 0.25);
  EXPECT_NEAR(fit.options.occluded_weight, truth.occluded_weight, 0.25);
  EXPECT_NEAR(fit.options.near_weight, truth.near_weight, 0.25);
  EXPECT_NEAR(fit.options.certain_weight, truth.certain_weight, 0.25);
  EXPECT_NEAR(fit.options.border_weight, truth.border_weight, 0.25);
  EXPECT_NEAR(fit.options.beside_weight, truth.beside_weight, 0.25);
  EXPECT_NEAR(fit.options.resolution_weight, truth.resolution_weight, 0.25);
  const double odds = static_cast<double>(fit.people) / static_cast<double>(fit.nobodies);
  EXPECT_NEAR(fit.options.bias, truth.bias - std::log(odds), 0.3);
  EXPECT_EQ(fit.people + fit.nobodies, 40000);
  EXPECT_GE(fit.area_after, fit.area_before);
}

TEST(FitScore, GivesNoWeightThatContradictsTheEvidence) {
  ScoreOptions truth = drawn_weights();
  truth.open_weight = -2.F;   // standing free cannot speak against a person
  truth.beside_weight = 2.F;  // nor body all around for one
  const ScoreFit fit = fit_score({drawn(truth, 20000, 5)}, {});
  EXPECT_EQ(fit.options.open_weight, 0.F);
  EXPECT_EQ(fit.options.beside_weight, 0.F);
  EXPECT_GT(fit.options.likelihood_weight, 3.F);  // what is left out makes the others a little weaker
  EXPECT_LT(fit.options.border_weight, -2.F);
}

TEST(FitScore, GivesFiniteWeightsForSeparableSets) {
  std::vector<ScoreSample> samples;
  for (int i = 0; i < 20; ++i) {
    const float x = (i < 10 ? 0.F : 0.4F) + 0.03F * static_cast<float>(i);
    samples.push_back({{x, 0.5F, 0.5F, 0.5F}, i >= 10});
  }
  const ScoreFit fit = fit_score({samples}, {});
  EXPECT_EQ(fit.area_after, 1.0);
  for (const ScoreSample& sample : samples) {
    EXPECT_EQ(person_score(sample.evidence, fit.options) > 0.5F, sample.person) << sample.evidence.likelihood;
  }
  EXPECT_NEAR(fit.options.open_weight, 0.F, 1e-3F);  // this evidence says nothing
}

TEST(FitScore, WeighsShortAndLongSequencesAlike) {
  // In the long sequence the outline separates people from nobodies, in the short one the core.
  std::vector<ScoreSample> longer, shorter;
  for (int i = 0; i < 1000; ++i) longer.push_back({{0.5F, 0.5F, i % 2 == 0 ? 0.8F : 0.2F, 0.5F}, i % 2 == 0});
  for (int i = 0; i < 10; ++i) shorter.push_back({{0.5F, 0.5F, 0.5F, i % 2 == 0 ? 0.8F : 0.2F}, i % 2 == 0});
  const ScoreFit fit = fit_score({longer, shorter}, {});
  EXPECT_GT(fit.options.core_weight, 0.8F * fit.options.open_weight);
}

TEST(FitScore, CountsEqualScoresAsHalfInOrder) {
  const Evidence same{0.5F, 0.5F, 0.5F, 0.5F};
  const ScoreFit fit = fit_score({{{same, true}, {same, false}, {same, false}}}, {});
  EXPECT_EQ(fit.area_before, 0.5);
}

TEST(FitScore, NeedsPeopleAndNobodies) {
  const Evidence e{0.5F, 0.5F, 0.5F, 0.5F};
  EXPECT_THAT([&] { fit_score({{{e, true}}}, {}); }, ThrowsMessage<Error>(HasSubstr("to be nobody")));
  EXPECT_THAT([&] { fit_score({{{e, false}}}, {}); }, ThrowsMessage<Error>(HasSubstr("to be a person")));
}

/// Returns a candidate whose mask has the given columns of a picture of 10 x 1.
Trace trace_of(int from, int to) {
  Trace trace;
  Trace::Candidate candidate;
  candidate.grown = Mask(10, 1, 0);
  for (int u = from; u < to; ++u) candidate.grown(u, 0) = 1;
  candidate.refined.found = 7;
  trace.candidates.push_back(candidate);
  return trace;
}

TEST(ScoreSamples, AreJudgedByTheirOverlap) {
  const DepthImage depth(10, 1, 2000);
  FrameTruth truth;
  truth.people = 1;
  truth.person = Image<std::uint8_t>(10, 1, kBackground);
  for (int u = 0; u < 4; ++u) truth.person(u, 0) = 0;
  const auto kinds = [&](const FrameTruth& known, int from, int to) {
    std::vector<int> all;
    for (const ScoreSample& s : score_samples(trace_of(from, to), known, depth)) all.push_back(s.person ? 1 : 0);
    return all;
  };
  EXPECT_THAT(kinds(truth, 0, 4), testing::ElementsAre(1));
  EXPECT_THAT(kinds(truth, 2, 4), testing::ElementsAre(1));  // IoU 0.5
  EXPECT_THAT(kinds(truth, 2, 6), testing::IsEmpty());       // IoU 1/3, which is undecided
  EXPECT_THAT(kinds(truth, 0, 1), testing::IsEmpty());       // a piece of a person
  EXPECT_THAT(kinds(truth, 5, 9), testing::ElementsAre(0));

  FrameTruth mask_only;
  mask_only.people = 1;
  mask_only.mask = Mask(10, 1, 0);
  for (int u = 0; u < 4; ++u) mask_only.mask(u, 0) = 255;
  EXPECT_THAT(kinds(mask_only, 2, 6), testing::ElementsAre(1));
  EXPECT_THAT(kinds(mask_only, 3, 6), testing::IsEmpty());
  EXPECT_THAT(kinds(mask_only, 2, 10), testing::ElementsAre(1));  // covers half of the mask
  EXPECT_THAT(kinds(mask_only, 4, 6), testing::ElementsAre(0));

  FrameTruth empty;
  empty.people = 0;
  EXPECT_THAT(kinds(empty, 0, 4), testing::ElementsAre(0));
  EXPECT_THAT(kinds({}, 0, 4), testing::IsEmpty());
}

}  // namespace
}  // namespace vesalius
