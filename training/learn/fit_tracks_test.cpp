#include "learn/fit_tracks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "vesalius/base/random.h"
#include "vesalius/error.h"
#include "vesalius/fit/flesh_joints.h"

namespace vesalius {
namespace {

/// Samples of two features, positive with the probability that weights and bias give.
struct Drawn {
  Eigen::MatrixXd features;
  Eigen::VectorXd positive, weight;
};

Drawn drawn(const LogisticFit& truth, Eigen::Index count) {
  Random random(5);
  Drawn d{Eigen::MatrixXd(2, count), Eigen::VectorXd(count), Eigen::VectorXd::Ones(count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    d.features(0, i) = random.normal(3.0, 2.0);
    d.features(1, i) = random.normal(0.0, 0.1);
    const double logit = truth.bias + truth.weights.dot(d.features.col(i));
    d.positive[i] = random.uniform() < 1.0 / (1.0 + std::exp(-logit)) ? 1.0 : 0.0;
  }
  return d;
}

TEST(FitLogistic, FindsTheWeightsThatMadeTheSamples) {
  const LogisticFit truth{Eigen::Vector2d(-0.6, 8.0), 1.5};
  const Drawn d = drawn(truth, 40000);
  const LogisticFit fit = fit_logistic(d.features, d.positive, d.weight);
  EXPECT_NEAR(fit.weights[0], -0.6, 0.03);
  EXPECT_NEAR(fit.weights[1], 8.0, 0.4);
  EXPECT_NEAR(fit.bias, 1.5, 0.1);
}

TEST(FitLogistic, ASampleThatWeighsTwiceIsTwoSamples) {
  Drawn d = drawn({Eigen::Vector2d(-0.6, 8.0), 1.5}, 500);
  d.weight.head(100).setConstant(2.0);
  Drawn twice{Eigen::MatrixXd(2, 600), Eigen::VectorXd(600), Eigen::VectorXd::Ones(600)};
  twice.features << d.features, d.features.leftCols(100);
  twice.positive << d.positive, d.positive.head(100);
  const LogisticFit a = fit_logistic(d.features, d.positive, d.weight);
  const LogisticFit b = fit_logistic(twice.features, twice.positive, twice.weight);
  // The ridge is on features that are standardised by the samples as they are, so that they differ a little.
  EXPECT_NEAR(a.weights[0], b.weights[0], 2e-3);
  EXPECT_NEAR(a.weights[1], b.weights[1], 2e-2);
}

TEST(FitLogistic, StaysFiniteWhereAPlaneSeparatesAll) {
  Drawn d = drawn({Eigen::Vector2d::Zero(), 0.0}, 200);
  for (Eigen::Index i = 0; i < 200; ++i) d.positive[i] = d.features(0, i) > 3.0 ? 1.0 : 0.0;
  const LogisticFit fit = fit_logistic(d.features, d.positive, d.weight);
  EXPECT_TRUE(fit.weights.allFinite() && std::isfinite(fit.bias));
  EXPECT_GT(fit.weights[0], 0.5);
}

TEST(FitLogistic, AFeatureThatNeverChangesGetsNoWeight) {
  Drawn d = drawn({Eigen::Vector2d(-0.6, 0.0), 1.5}, 1000);
  d.features.row(1).setConstant(4.0);
  EXPECT_NEAR(fit_logistic(d.features, d.positive, d.weight).weights[1], 0.0, 1e-9);
}

using testing::HasSubstr;
using testing::ThrowsMessage;

/// Joints that are right with the probability of `truth`.
void draw(JointSource source, const JointTrust& truth, int count, std::vector<TrustSample>& samples) {
  Random random(7 + static_cast<std::uint64_t>(source));
  for (int i = 0; i < count; ++i) {
    TrustSample sample{source, {}, false};
    sample.signals.log_sigma = static_cast<float>(random.normal(-3.0, 0.5));
    sample.signals.misfit = static_cast<float>(random.normal(0.8, 0.3));
    sample.right = random.uniform() < static_cast<double>(trusted(truth, sample.signals));
    samples.push_back(sample);
  }
}

TEST(FitTrust, FindsTheTrustThatMadeTheSamples) {
  const JointTrust observed{-5.F, {.log_sigma = -2.2F, .misfit = -1.F}};
  const JointTrust predicted{-4.F, {.log_sigma = -1.F}};
  std::vector<TrustSample> samples;
  draw(JointSource::observed, observed, 30000, samples);
  draw(JointSource::predicted, predicted, 30000, samples);
  draw(JointSource::hidden, predicted, 100, samples);
  BodyTrust start;
  start.hidden.bias = 0.25F;
  const TrustFit fit = fit_trust(samples, start);
  EXPECT_NEAR(fit.trust.observed.bias, -5.F, 0.3F);
  EXPECT_NEAR(fit.trust.observed.weights.log_sigma, -2.2F, 0.1F);
  EXPECT_NEAR(fit.trust.observed.weights.misfit, -1.F, 0.15F);
  EXPECT_EQ(fit.trust.observed.weights.unseen_s, 0.F) << "it never changes";
  EXPECT_NEAR(fit.trust.predicted.weights.log_sigma, -1.F, 0.1F);
  EXPECT_EQ(fit.trust.hidden.bias, 0.25F) << "too few to fit";

  const TrustAgreement& agreement = fit.agreement[static_cast<std::size_t>(JointSource::observed)];
  EXPECT_TRUE(agreement.fitted);
  EXPECT_EQ(agreement.samples, 30000);
  EXPECT_LT(agreement.after, 0.01);
  EXPECT_GT(agreement.before, 0.1) << "every joint was given 50 %";
  EXPECT_FALSE(fit.agreement[static_cast<std::size_t>(JointSource::hidden)].fitted);
}

TEST(FitTrust, RefusesTooFewSamples) {
  std::vector<TrustSample> samples;
  draw(JointSource::observed, {}, 300, samples);
  EXPECT_THAT([&] { fit_trust(samples, {}); }, ThrowsMessage<Error>(HasSubstr("at least 200 right and 200 wrong")));
}

TEST(FitTrust, TakesTheJointsOfTheBodyWhoseTruthIsKnown) {
  const std::vector<JointSet>& sets = paper_body().joint_sets;
  const auto set = std::ranges::find(sets, "nite15", &JointSet::name);
  ASSERT_NE(set, sets.end());
  TrackedPerson found;
  for (const JointSet& each : sets) {
    found.person.joints.emplace_back(each.joints.size(), Joint{State::observed, {0.F, 0.F, 2.F}, 0.5F});
  }
  const std::vector<std::string> names{"head", "l_knee", "r_knee", "neck"};
  const Eigen::Vector3f unknown = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  const std::vector<Eigen::Vector3f> truth{{0.F, 0.09F, 2.F}, {0.F, 0.11F, 2.F}, unknown, {0.F, 0.F, 2.F}};
  std::vector<TrustSample> samples;
  add_trust_samples(found, sets, *set, names, truth, samples);
  EXPECT_TRUE(samples.empty()) << "nobody without a body";

  const FleshModel& flesh = builtin_flesh();
  found.body.emplace();
  found.body->bones.resize(flesh.bones.size());
  FittedBone& head = found.body->bones[flesh.find_bone("head")];
  head.state = State::observed;
  head.of_head.misfit = 1.F;
  head.of_tail.misfit = 3.F;
  found.body->bones[flesh.find_bone("l_shin")].state = State::predicted;
  add_trust_samples(found, sets, *set, names, truth, samples);
  ASSERT_EQ(samples.size(), 3U);
  EXPECT_EQ(samples[0].source, JointSource::observed);
  EXPECT_TRUE(samples[0].right);
  EXPECT_NEAR(samples[0].signals.misfit, 2.F, 1e-6F) << "the middle of the head";
  EXPECT_EQ(samples[1].source, JointSource::predicted);
  EXPECT_FALSE(samples[1].right);

  found.body->hidden = true;
  samples.clear();
  add_trust_samples(found, sets, *set, names, truth, samples);
  for (const TrustSample& sample : samples) EXPECT_EQ(sample.source, JointSource::hidden);
}

/// People of one stance whose chest is so high on average, and of whom the highest pixels are seen half of the time.
void draw(Stance stance, double chest_m, double trunk_up, int count, std::vector<StanceSample>& samples) {
  Random random(7 + static_cast<std::uint64_t>(stance));
  for (int i = 0; i < count; ++i) {
    StanceSample sample{{}, stance};
    sample.posture.stature_m = 1.7F;
    sample.posture.chest_m = static_cast<float>(random.normal(chest_m, 0.08));
    sample.posture.trunk_up = static_cast<float>(random.normal(trunk_up, 0.15));
    if (random.uniform() < 0.5) sample.posture.top_m = *sample.posture.chest_m + 0.3F;
    samples.push_back(sample);
  }
}

std::vector<StanceSample> drawn() {
  std::vector<StanceSample> samples;
  draw(Stance::standing, 1.2, 0.9, 400, samples);
  draw(Stance::sitting, 0.8, 0.9, 200, samples);
  draw(Stance::lying, 0.2, 0.1, 300, samples);
  return samples;
}

TEST(FitStances, TellsThePeopleThatItWasFittedTo) {
  const StanceFit fit = fit_stances(drawn(), {});
  for (const StanceAgreement& agreement : fit.agreement) {
    EXPECT_GT(agreement.right_after, 0.97 * static_cast<double>(agreement.samples)) << to_string(agreement.stance);
    if (agreement.stance == Stance::lying) continue;
    EXPECT_EQ(agreement.right_before, 0) << "a model without weights takes everybody for lying as soon as not";
  }
  EXPECT_EQ(fit.agreement[0].samples, 400);
}

TEST(FitStances, KnowsBedsAndPicturesWithoutFloor) {
  const StanceFit fit = fit_stances(drawn(), {});
  Posture in_bed;
  in_bed.stature_m = 1.7F;
  in_bed.chest_m = 0.65F;
  in_bed.trunk_up = 0.1F;
  EXPECT_GT(stance_probabilities(fit.model, in_bed).lying, 0.7F);
  Posture sits = in_bed;
  sits.trunk_up = 0.9F;
  EXPECT_GT(stance_probabilities(fit.model, sits).sitting, 0.7F);
  Posture without_floor;
  without_floor.trunk_up = 0.F;
  EXPECT_GT(stance_probabilities(fit.model, without_floor).lying, 0.9F);
  without_floor.trunk_up = 1.F;
  EXPECT_LT(stance_probabilities(fit.model, without_floor).lying, 0.1F);
}

TEST(FitStances, RefusesTooFewSamples) {
  std::vector<StanceSample> samples = drawn();
  std::erase_if(samples, [](const StanceSample& sample) { return sample.stance == Stance::sitting; });
  EXPECT_THAT([&] { fit_stances(samples, {}); }, ThrowsMessage<Error>(HasSubstr("0 people found sitting")));
}

}  // namespace

}  // namespace vesalius
