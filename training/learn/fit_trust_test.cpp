#include "learn/fit_trust.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>

#include "vesalius/base/random.h"
#include "vesalius/error.h"
#include "vesalius/fit/flesh_joints.h"

namespace vesalius {
namespace {

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

}  // namespace
}  // namespace vesalius
