#include "vesalius/default_judge.h"

#include <gmock/gmock.h>

#include <limits>

#include "vesalius/base/error.h"
#include "vesalius/score_person.h"

namespace vesalius {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

/// Returns what the default judge says of evidence of the given strength, 0-1.
float score_of(float strength) {
  Evidence evidence;
  for (const JudgedEvidence& kind : kJudgedEvidence) {
    if (kind.sign != 0) evidence.*kind.evidence = kind.sign > 0 ? strength : 1.F - strength;
  }
  evidence.near = 0.4F;
  evidence.resolution = 0.7F;
  evidence.depth_m = 0.1F;
  evidence.length_m = 0.4F;
  evidence.slant = 0.9F;
  evidence.bend_m = 0.02F;
  evidence.ragged = 8.F;
  evidence.rivals = 2.F;
  std::vector<float> features = judge_features(evidence);
  features.resize(kJudgedEvidence.size());
  return default_judge().probability(features);
}

TEST(DefaultJudge, TellsSomebodyFromNobody) {
  EXPECT_GT(score_of(0.95F), 0.8F);
  EXPECT_LT(score_of(0.1F), 0.2F);
  EXPECT_LE(score_of(0.3F), score_of(0.6F));
}

TEST(DefaultJudge, AsksForNothingThatABodyLacks) {
  const BoostedTrees& judge = default_judge();
  check(judge, "judge");
  for (const std::string& name : judge.asks) EXPECT_THAT(judge_names(paper_body()), testing::Contains(name));
  const std::vector<std::string> names = judge_names(paper_body());
  EXPECT_EQ(in_order(judge, names, "judge").features, static_cast<int>(names.size()));
}

TEST(ParseBoostedTrees, ReadsWhatIsWritten) {
  EXPECT_EQ(parse_boosted_trees(to_toml(default_judge()), "again"), default_judge());
  BoostedTrees trees{2, 0.1F, {{}}, {"a", "b"}};
  trees.trees[0].threshold.fill(std::numeric_limits<float>::infinity());
  trees.trees[0].threshold[0] = 1.F / 3.F;
  trees.trees[0].feature[0] = 1;
  trees.trees[0].value[8] = -1e-7F;
  EXPECT_EQ(parse_boosted_trees(to_toml(trees), "again"), trees);
}

TEST(ParseBoostedTrees, NamesTheLineOfWhatItCannotUse) {
  std::string toml = to_toml({1, 0.F, {{}}, {"a"}});
  const std::size_t at = toml.find("\"a\", \"a\"");
  toml.replace(at, 3, "\"z\"");
  EXPECT_THAT([&] { parse_boosted_trees(toml, "bad"); }, ThrowsMessage<Error>(HasSubstr("bad:5: asks for \"z\"")));
  EXPECT_THAT([&] { parse_boosted_trees("asks = []\nbias = nan\ntree = []", "bad"); },
              ThrowsMessage<Error>(HasSubstr("bad:2: bias")));
  EXPECT_THAT(
      [&] { parse_boosted_trees("asks = []\nbias = 0.0\ntree = [{asks = [], above = [], value = []}]", "bad"); },
      ThrowsMessage<Error>(HasSubstr("bad:3: asks: expected a name")));
}

}  // namespace
}  // namespace vesalius
