#include "learn/fit_boosted.h"

#include <gmock/gmock.h>

#include <cmath>

#include "vesalius/base/random.h"
#include "vesalius/error.h"
#include "vesalius/forest/body_context.h"
#include "vesalius/score_person.h"

namespace vesalius {
namespace {

using testing::HasSubstr;

/// Samples of which the first feature tells more or less what they are.
std::vector<BoostSample> samples(std::size_t features, int count) {
  Random random(1);
  std::vector<BoostSample> all;
  for (int i = 0; i < count; ++i) {
    BoostSample& sample = all.emplace_back();
    for (std::size_t f = 0; f < features; ++f) sample.features.push_back(static_cast<float>(random.uniform(0.0, 1.0)));
    sample.positive = random.uniform(0.0, 1.0) < static_cast<double>(sample.features[0]);
  }
  return all;
}

template <class Fit>
std::string refusal(const Fit& fit, bool positive) {
  std::vector<BoostSample> one_kind = samples(3, 20);
  for (BoostSample& sample : one_kind) sample.positive = positive;
  try {
    fit(one_kind, paper_body());
  } catch (const Error& e) {
    return e.what();
  }
  return "nothing";
}

TEST(FitContext, NamesWhatItAsksForAndRaisesTheOddsOfBodies) {
  const BodyModel& body = paper_body();
  std::vector<BoostSample> known = samples(static_cast<std::size_t>(BodySurroundings::feature_count(body)), 4000);
  const BoostedTrees context = fit_context(known, body);
  EXPECT_EQ(context.asks, BodySurroundings::feature_names(body));
  EXPECT_EQ(context.trees.size(), 120U);
  // Half of the samples are bodies, so that the odds of all of them are 7 instead of 1.
  double log_odds = 0.0;
  for (const BoostSample& sample : known) {
    const double p = static_cast<double>(context.probability(sample.features));
    log_odds += std::log(p / (1.0 - p)) / static_cast<double>(known.size());
  }
  EXPECT_NEAR(log_odds, std::log(7.0), 0.2);
}

TEST(FitJudge, NamesWhatItAsksFor) {
  const BodyModel& body = paper_body();
  const std::vector<std::string> names = judge_names(body);
  const BoostedTrees judge = fit_judge(samples(names.size(), 500), body);
  EXPECT_EQ(judge.asks, names);
  EXPECT_EQ(judge.trees.size(), 1600U);
}

TEST(FitBoosted, RefusesSamplesOfOneKind) {
  EXPECT_THAT(refusal(fit_judge, false), HasSubstr("no candidate that is known to be a person"));
  EXPECT_THAT(refusal(fit_judge, true), HasSubstr("no candidate that is known to be nobody"));
  EXPECT_THAT(refusal(fit_context, false), HasSubstr("no pixel that may be a body and is known to be one"));
  EXPECT_THAT(refusal(fit_context, true), HasSubstr("no pixel that may be a body and is known to be none"));
}

}  // namespace
}  // namespace vesalius
