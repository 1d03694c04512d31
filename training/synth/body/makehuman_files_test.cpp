#include "synth/body/makehuman_files.h"

#include <gmock/gmock.h>

#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StrEq;
using testing::ThrowsMessage;

// The text of a tetrahedron with a helper vertex and a face of another group.
const std::string kObj =
    "# a comment\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 5 5 5\nvt 0 0\ng helper\nf 1 2 5\ng body\n"
    "f 1/1 3/2 2/3\nf 1/1/1 2/2/2 4/4/4\nf 2 3 4\nf 1 4 3\n";

std::string changed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

void expect_obj_error(const std::string& text, const std::string& message) {
  EXPECT_THAT([&] { parse_obj(text, "base.obj", "body"); }, ThrowsMessage<Error>(HasSubstr(message)));
}

TEST(ParseObj, KeepsTheNumbersOfAllVerticesAndTheFacesOfOneGroup) {
  const ObjGroup mesh = parse_obj(kObj, "base.obj", "body");
  ASSERT_EQ(mesh.vertices.size(), 5U);
  EXPECT_EQ(mesh.vertices[4], Eigen::Vector3f(5.F, 5.F, 5.F));
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 2, 1}, Triangle{0, 1, 3}, Triangle{1, 2, 3}, Triangle{0, 3, 2}));
}

TEST(ParseObj, CutsPolygonsIntoFans) {
  const std::string cube =
      "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\ng body\n"
      "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4\n";
  const ObjGroup mesh = parse_obj(cube, "cube.obj", "body");
  ASSERT_EQ(mesh.triangles.size(), 12U);
  EXPECT_EQ(mesh.triangles[1], (Triangle{0, 2, 1}));
}

TEST(ParseObj, NamesTheLineOfErrors) {
  expect_obj_error(changed(kObj, "v 1 0 0", "v 1 x 0"),
                   "base.obj:3: expected a coordinate (a number up to 1e+06), found \"x\"");
  expect_obj_error(changed(kObj, "v 1 0 0", "v nan 0 0"), "found \"nan\"");
  expect_obj_error(changed(kObj, "v 1 0 0", "v 1 0"),
                   "base.obj:3: expected three coordinates, found the end of the line");
  expect_obj_error(changed(kObj, "f 2 3 4", "f 2 3 6"),
                   "base.obj:13: expected a vertex number from 1 to 5, found \"6\"");
  expect_obj_error(changed(kObj, "f 2 3 4", "f 0 3 4"),
                   "base.obj:13: expected a vertex number from 1 to 5, found \"0\"");
  expect_obj_error(changed(kObj, "f 2 3 4", "f 2 3"), "base.obj:13: face of 2 corners");
  expect_obj_error(changed(kObj, "v 1 0 0", "v 1 0 2000"), "base.obj:3: expected a coordinate below 1000 in size");
  expect_obj_error("", "no faces in group \"body\"");
}

TEST(ParseObj, NoticesAFileTruncatedAnywhereInItsFaces) {
  const std::size_t first_face = kObj.find("f 1/1 3/2");
  for (std::size_t end = first_face + 1; end + 2 < kObj.size(); ++end) {
    EXPECT_THROW(parse_obj(kObj.substr(0, end), "base.obj", "body"), Error) << end;
  }
}

TEST(ParseTarget, ReadsOffsetsAndSkipsComments) {
  const MorphTarget target = parse_target("# note\n\n3 .5 -1e-1 2\n0 0 0 .25\n", "a.target", 5);
  EXPECT_THAT(target.vertex, ElementsAre(3, 0));
  EXPECT_EQ(target.offset[0], Eigen::Vector3f(0.5F, -0.1F, 2.F));
  EXPECT_TRUE(parse_target("# the base's own shape\n", "a.target", 5).vertex.empty());
}

TEST(ParseTarget, NamesTheLineOfErrors) {
  const auto expect = [](const std::string& text, const std::string& message) {
    EXPECT_THAT([&] { parse_target(text, "a.target", 5); }, ThrowsMessage<Error>(HasSubstr(message)));
  };
  expect("0 0 0 0\n5 0 0 0\n", "a.target:2: expected a vertex (a whole number from 0 to 4), found \"5\"");
  expect("0 0 0\n", "a.target:1: expected three coordinates, found the end of the line");
  expect("0 0 0 0 0\n", "a.target:1: expected the end of the line");
  expect("-1 0 0 0\n", "a.target:1: expected a vertex (a whole number from 0 to 4), found \"-1\"");
  expect("1 nan 0 0\n", "a.target:1: expected a coordinate (a number up to 1e+06), found \"nan\"");
}

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StrEq;
using testing::ThrowsMessage;

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
