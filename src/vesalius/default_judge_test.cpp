#include "vesalius/default_judge.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>

#include "vesalius/error.h"
#include "vesalius/score_person.h"

namespace vesalius {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

/// Returns what a judge says of evidence of the given strength, 0-1.
float score_of(const BoostedTrees& judge, float strength) {
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
  evidence.parts.resize(kind_count(part_slots(paper_body())), 0.F);
  return in_order(judge, judge_names(paper_body()), "judge").probability(judge_features(evidence));
}

TEST(DefaultJudge, TellsSomebodyFromNobody) {
  for (const BoostedTrees& judge : {default_judge(), default_judge_of_cut_outs()}) {
    EXPECT_GT(score_of(judge, 0.95F), 0.7F);
    EXPECT_LT(score_of(judge, 0.1F), 0.2F);
    EXPECT_LE(score_of(judge, 0.3F), score_of(judge, 0.6F));
  }
}

TEST(DefaultJudge, AsksForNothingThatABodyLacks) {
  for (const BoostedTrees& judge : {default_judge(), default_judge_of_cut_outs()}) {
    check(judge, "judge");
    for (const std::string& name : judge.asks) {
      EXPECT_TRUE(std::ranges::any_of(kJudgedEvidence, [&](const JudgedEvidence& kind) { return kind.name == name; }));
    }
  }
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
