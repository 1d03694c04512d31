#include "learn/fit_boosted.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "vesalius/base/random.h"
#include "vesalius/error.h"
#include "vesalius/forest/body_context.h"
#include "vesalius/parallel.h"
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

/// Returns samples with three uniformly random features, which are positive with the given probability.
std::vector<BoostSample> draw(int count, std::uint64_t seed,
                              const std::function<double(const std::vector<float>&)>& probability) {
  Random random(seed);
  std::vector<BoostSample> samples(count);
  for (BoostSample& sample : samples) {
    for (int i = 0; i < 3; ++i) sample.features.push_back(static_cast<float>(random.uniform()));
    sample.positive = random.uniform() < probability(sample.features);
  }
  return samples;
}

/// Neither feature says anything alone.
double either_but_not_both(const std::vector<float>& e) { return (e[0] > 0.5F) != (e[1] > 0.5F) ? 0.9 : 0.1; }

double mean_error(const BoostedTrees& trees, const std::vector<BoostSample>& samples,
                  const std::function<double(const std::vector<float>&)>& probability) {
  double sum = 0.0;
  for (const BoostSample& sample : samples) {
    sum += std::abs(static_cast<double>(trees.probability(sample.features)) - probability(sample.features));
  }
  return sum / static_cast<double>(samples.size());
}

TEST(BoostTrees, FindsProbabilitiesThatNoLineSeparates) {
  const BoostedTrees trees = boost_trees(draw(6000, 1, either_but_not_both), {0, 0, 0});
  EXPECT_LT(mean_error(trees, draw(2000, 2, either_but_not_both), either_but_not_both), 0.06);
}

TEST(BoostTrees, NeverContradictsASign) {
  const auto falling = [](const std::vector<float>& e) { return 0.9 - 0.8 * static_cast<double>(e[0]); };
  const std::vector<BoostSample> samples = draw(3000, 3, falling);
  for (const int sign : {1, -1}) {
    const BoostedTrees trees = boost_trees(samples, {sign, 0, 0});
    Random random(4);
    int differs = 0;
    for (int i = 0; i < 500; ++i) {
      const auto rest = std::vector<float>{static_cast<float>(random.uniform()), static_cast<float>(random.uniform())};
      float last = 0.F;
      for (int step = 0; step <= 20; ++step) {
        const float p = trees.probability({static_cast<float>(step) / 20.F, rest[0], rest[1]});
        if (step > 0) {
          EXPECT_GE(static_cast<float>(sign) * (p - last), 0.F);
        }
        differs += step > 0 && p != last ? 1 : 0;
        last = p;
      }
    }
    if (sign < 0) {
      EXPECT_GT(differs, 1000) << "a feature that agrees with its sign is used";
    }
  }
}

TEST(BoostTrees, TellsCountsApart) {
  // Three values, none of which ends where a bin of as many samples would.
  std::vector<BoostSample> samples = draw(3000, 8, [](const std::vector<float>&) { return 0.0; });
  Random random(9);
  for (BoostSample& sample : samples) {
    sample.features[0] = static_cast<float>(random.below(3));
    sample.positive = sample.features[0] == 1.F;
  }
  const BoostedTrees trees = boost_trees(samples, {0, 0, 0});
  EXPECT_LT(trees.probability({0.F, 0.5F, 0.5F}), 0.05F);
  EXPECT_GT(trees.probability({1.F, 0.5F, 0.5F}), 0.95F);
  EXPECT_LT(trees.probability({2.F, 0.5F, 0.5F}), 0.05F);
}

TEST(BoostTrees, LearnsNothingFromFewerSamplesThanALeafMayHave) {
  // Of 2,000 samples some 40 stand out, and all of those are positive.
  std::vector<BoostSample> samples = draw(2000, 5, [](const std::vector<float>&) { return 0.2; });
  for (BoostSample& sample : samples) sample.positive = sample.positive || sample.features[0] > 0.98F;
  BoostOptions options;
  const auto rises = [&] {
    const BoostedTrees trees = boost_trees(samples, {0, 0, 0}, options);
    return trees.probability({0.995F, 0.5F, 0.5F}) - trees.probability({0.9F, 0.5F, 0.5F});
  };
  options.least_samples = 10;
  EXPECT_GT(rises(), 0.3F);
  options.least_samples = 400;
  EXPECT_LT(rises(), 0.1F);
}

TEST(BoostTrees, IsTheSameForAnyNumberOfThreads) {
  const std::vector<BoostSample> samples = draw(500, 6, either_but_not_both);
  const BoostedTrees trees = boost_trees(samples, {0, 1, -1});
  const ThreadLimit one(1);
  EXPECT_EQ(boost_trees(samples, {0, 1, -1}), trees);
}

TEST(BoostTrees, RefusesSamplesWithoutAnswer) {
  const auto all = [](double p) { return draw(10, 7, [p](const std::vector<float>&) { return p; }); };
  EXPECT_THROW(boost_trees(all(1.0), {0, 0, 0}), Error);
  EXPECT_THROW(boost_trees(all(0.0), {0, 0, 0}), Error);
  EXPECT_THROW(boost_trees({}, {0, 0, 0}), Error);
  EXPECT_THROW(boost_trees(draw(10, 8, either_but_not_both), {0, 0}), Error);
}

}  // namespace

}  // namespace vesalius
