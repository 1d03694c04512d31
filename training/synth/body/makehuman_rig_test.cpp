#include "synth/body/makehuman_rig.h"

#include <gmock/gmock.h>

#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StrEq;
using testing::ThrowsMessage;

std::string changed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

const std::string kSkeleton =
    R"({"bones": {"arm": {"head": "a", "tail": "b", "parent": "root"},
 "root": {"head": "b", "tail": "a", "parent": null}},
 "joints": {"a": [0, 1], "b": [4]}})";

TEST(ParseSkeleton, PutsParentsFirst) {
  const auto bones = parse_skeleton(kSkeleton, "x.mhskel", 5);
  ASSERT_EQ(bones.size(), 2U);
  EXPECT_EQ(bones[0].name, "root");
  EXPECT_EQ(bones[0].parent, -1);
  EXPECT_EQ(bones[1].name, "arm");
  EXPECT_EQ(bones[1].parent, 0);
  EXPECT_THAT(bones[1].head, ElementsAre(0, 1));
  EXPECT_THAT(bones[1].tail, ElementsAre(4));
}

TEST(ParseSkeleton, NamesTheReasonOfErrors) {
  const auto expect = [](const std::string& from, const std::string& to, const std::string& message) {
    const std::string text = changed(kSkeleton, from, to);
    EXPECT_THAT([&] { parse_skeleton(text, "x.mhskel", 5); }, ThrowsMessage<Error>(HasSubstr(message))) << to;
  };
  expect("[4]", "[5]", "x.mhskel: joint \"b\": vertex 5, expected 0 to 4");
  expect("[4]", "[-1]", "joint \"b\": vertex -1");
  expect("[4]", "[]", "joint \"b\": expected a list of vertices");
  expect("\"tail\": \"b\"", "\"tail\": \"c\"", "joint \"c\": expected a list of vertices");
  expect("\"tail\": \"b\"", "\"tail\": 1", "bone \"arm\": expected a text \"tail\"");
  expect("\"root\"}", "\"arm\"}", "bone \"arm\": its parents form a ring or one is missing");
  expect("\"joints\"", "\"joint\"", "expected an object \"joints\"");
  expect("null", "null,,", "x.mhskel:2: not valid JSON");
  expect("[4]", "[1e999]", "not valid JSON: a number beyond all bounds");
  EXPECT_THROW(parse_skeleton("", "x", 5), Error);
  EXPECT_THROW(parse_skeleton("[]", "x", 5), Error);
}

TEST(ParseWeights, KeepsTheFourLargestAndMakesThemSumToOne) {
  std::vector<SkeletonBone> bones(6);
  std::string json = "{\"weights\": {";
  for (int b = 0; b < 6; ++b) {
    bones[b].name = std::string(1, static_cast<char>('a' + b));
    json += std::string(b == 0 ? "" : ",") + "\"" + bones[b].name + "\": [[2, 0." + std::to_string(b == 0 ? 50 : 10) +
            "]" + (b == 3 ? ", [0, 1.0]" : "") + "]";
  }
  const auto weights = parse_weights(json + "}}", "x.mhw", bones, 3, {2, 0});
  ASSERT_EQ(weights.size(), 2U);
  EXPECT_THAT(weights[0].bone, ElementsAre(0, 1, 2, 3));
  EXPECT_NEAR(weights[0].weight[0], 0.5F / 0.8F, 1e-6F);
  EXPECT_NEAR(weights[0].weight[3], 0.1F / 0.8F, 1e-6F);
  EXPECT_EQ(weights[1].bone[0], 3);
  EXPECT_EQ(weights[1].weight[0], 1.F);
  EXPECT_EQ(weights[1].weight[1], 0.F);
}

TEST(ParseWeights, NamesTheReasonOfErrors) {
  std::vector<SkeletonBone> bones(1);
  bones[0].name = "a";
  const auto expect = [&](const std::string& text, const std::string& message) {
    EXPECT_THAT([&] { parse_weights(text, "x.mhw", bones, 3, {1}); }, ThrowsMessage<Error>(StrEq(message)));
  };
  expect(R"({"weights": {"a": [[1, 0.5]]}})", "x.mhw: vertex 1: its weights sum to 0.5, expected 1 within 0.1");
  expect(R"({"weights": {"a": []}})", "x.mhw: vertex 1: its weights sum to 0, expected 1 within 0.1");
  expect(R"({"weights": {"b": [[1, 1]]}})", "x.mhw: weights of bone \"b\": the skeleton has no such bone");
  const std::string pair = ", expected [vertex from 0 to 2, weight from 0 to 1]";
  expect(R"({"weights": {"a": [[3, 1]]}})", "x.mhw: weights of bone \"a\": [3,1]" + pair);
  expect(R"({"weights": {"a": [[1, 2.0]]}})", "x.mhw: weights of bone \"a\": [1,2.0]" + pair);
  expect(R"({"weights": {"a": [[1]]}})", "x.mhw: weights of bone \"a\": [1]" + pair);
  expect(R"({"weights": {"a": 1}})", "x.mhw: weights of bone \"a\": expected a list");
  expect("{", "x.mhw:1: not valid JSON");
}

}  // namespace
}  // namespace vesalius::synth
