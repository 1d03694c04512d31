#include "learn/fit_vote_judge.h"

#include <gmock/gmock.h>

#include <cmath>

#include "vesalius/base/random.h"
#include "vesalius/error.h"
#include "vesalius/score_person.h"

namespace vesalius {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

std::size_t feature(const std::string& name) {
  const std::vector<std::string> names = judge_names(paper_body());
  return std::size_t(std::ranges::find(names, name) - names.begin());
}

/// Candidates whose log odds are `of`(votes, size), both in -1 to 1; all other evidence is noise.
template <class LogOdds>
std::vector<BoostSample> candidates(int count, std::uint64_t seed, const LogOdds& of) {
  Random random(seed);
  std::vector<BoostSample> all;
  for (int i = 0; i < count; ++i) {
    BoostSample& sample = all.emplace_back();
    for (std::size_t f = 0; f < judge_names(paper_body()).size(); ++f) {
      sample.features.push_back(float(random.uniform(-1.0, 1.0)));
    }
    const double odds =
        std::exp(of(double(sample.features[feature("votes")]), double(sample.features[feature("size")])));
    sample.positive = random.uniform(0.0, 1.0) < odds / (1.0 + odds);
  }
  return all;
}

double log_odds(const BoostedTrees& judge, const std::vector<float>& features) {
  float odds = 0.F;
  judge.log_odds(features.data(), 1, &odds);
  return double(odds);
}

TEST(FitVoteJudge, FindsTheOddsThatMadeTheSamples) {
  const auto truth = [](double votes, double size) { return 0.5 + 3.0 * votes - 2.0 * size * size; };
  const BoostedTrees judge = fit_vote_judge(candidates(20000, 1, truth), paper_body());
  for (const double votes : {-0.8, -0.3, 0.0, 0.4, 0.8}) {
    for (const double size : {-0.8, 0.0, 0.5}) {
      std::vector<float> features(judge_names(paper_body()).size(), 0.F);
      features[feature("votes")] = float(votes);
      features[feature("size")] = float(size);
      // A false person costs 3 times as much; steps of a sixteenth of the range, four of them staggered.
      EXPECT_NEAR(log_odds(judge, features), truth(votes, size) - std::log(3.0), 0.45) << votes << " " << size;
    }
  }
}

TEST(FitVoteJudge, AsksForNothingElse) {
  const BoostedTrees judge =
      fit_vote_judge(candidates(500, 2, [](double votes, double) { return votes; }), paper_body());
  EXPECT_EQ(judge.asks, judge_names(paper_body()));
  std::vector<float> some(judge.asks.size(), 0.2F), other = some;
  for (const char* name : {"body", "surest", "beside", "bend", "heading"}) other[feature(name)] = 0.9F;
  EXPECT_EQ(log_odds(judge, some), log_odds(judge, other));
}

TEST(FitVoteJudge, RefusesSamplesOfOneKind) {
  std::vector<BoostSample> one = candidates(20, 3, [](double, double) { return 0.0; });
  for (BoostSample& sample : one) sample.positive = false;
  EXPECT_THAT([&] { fit_vote_judge(one, paper_body()); }, ThrowsMessage<Error>(HasSubstr("known to be a person")));
  for (BoostSample& sample : one) sample.positive = true;
  EXPECT_THAT([&] { fit_vote_judge(one, paper_body()); }, ThrowsMessage<Error>(HasSubstr("known to be nobody")));
}

TEST(FitVoteJudge, BearsEvidenceThatIsAlwaysTheSame) {
  std::vector<BoostSample> all = candidates(200, 4, [](double votes, double) { return 4.0 * votes; });
  for (BoostSample& sample : all) sample.features[feature("groups")] = 1.F;
  const BoostedTrees judge = fit_vote_judge(all, paper_body());
  EXPECT_NO_THROW(check(judge, "judge"));
  EXPECT_TRUE(std::isfinite(log_odds(judge, all.front().features)));
}

}  // namespace
}  // namespace vesalius
