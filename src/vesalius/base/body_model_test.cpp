#include "vesalius/body_model.h"

#include <gmock/gmock.h>

#include <fstream>
#include <numeric>
#include <set>
#include <sstream>

#include "vesalius/error.h"

namespace vesalius {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using testing::ThrowsMessage;

// The smallest body with a pair has three parts. The tests depend on its line numbers.
constexpr const char* kSmall = R"(name = "small"
roots = ["trunk"]
[[part]]
name = "trunk"
colour = [1, 2, 3]
mirror = "trunk"
max_extent = 1
area = 0.1
upper_body = true
[[part]]
name = "l_arm"
colour = [4, 5, 6]
mirror = "r_arm"
max_extent = 0.7
area = 0.05
upper_body = true
[[part]]
name = "r_arm"
colour = [7, 8, 9]
mirror = "l_arm"
max_extent = 0.7
area = 0.05
upper_body = false
[[link]]
parent = "trunk"
child = "l_arm"
length = 0.3
tolerance = 0.15
[[link]]
parent = "trunk"
child = "r_arm"
length = 0.3
tolerance = 0.15
[[joint_set]]
name = "two"
[[joint_set.joint]]
name = "between"
parts = ["l_arm", "r_arm"]
weights = [0.25, 0.75]
depth_offset = 0.05
[[joint_set.joint]]
name = "tail"
parts = []
)";

/// Returns the small body's text with the first `from` after `after` replaced.
std::string changed(const std::string& from, const std::string& to, const std::string& after = "") {
  std::string text = kSmall;
  const std::size_t start = after.empty() ? 0 : text.find(after);
  const std::size_t at = text.find(from, start);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(BodyModel, ReadsEveryField) {
  const BodyModel body = parse_body_model(kSmall, "small.toml");
  EXPECT_EQ(body.name, "small");
  ASSERT_EQ(body.part_count(), 3);
  EXPECT_EQ(body.parts[1].name, "l_arm");
  EXPECT_EQ(body.parts[1].colour, (Rgb{4, 5, 6}));
  EXPECT_EQ(body.parts[1].mirror, 2);
  EXPECT_EQ(body.parts[0].mirror, 0);
  EXPECT_FLOAT_EQ(body.parts[0].max_extent_m, 1.F);
  EXPECT_FLOAT_EQ(body.parts[2].typical_area_m2, 0.05F);
  EXPECT_TRUE(body.parts[1].upper_body);
  EXPECT_FALSE(body.parts[2].upper_body);
  ASSERT_EQ(body.links.size(), 2U);
  EXPECT_EQ(body.links[1].parent, 0);
  EXPECT_EQ(body.links[1].child, 2);
  EXPECT_FLOAT_EQ(body.links[1].length_m, 0.3F);
  EXPECT_FLOAT_EQ(body.links[1].tolerance_m, 0.15F);
  EXPECT_EQ(body.roots, std::vector<int>{0});
  ASSERT_EQ(body.joint_sets.size(), 1U);
  const JointSet& set = body.joint_sets[0];
  ASSERT_EQ(set.joints.size(), 2U);
  EXPECT_EQ(set.joints[0].parts, (std::vector<int>{1, 2}));
  EXPECT_EQ(set.joints[0].weights, (std::vector<float>{0.25F, 0.75F}));
  EXPECT_FLOAT_EQ(set.joints[0].depth_offset_m, 0.05F);
  EXPECT_EQ(set.joints[0].up_offset_m, 0.F);
  const std::string with_up = changed("depth_offset = 0.05", "depth_offset = 0.05\nup_offset = -0.02");
  EXPECT_FLOAT_EQ(parse_body_model(with_up, "b.toml").joint_sets[0].joints[0].up_offset_m, -0.02F);
  EXPECT_TRUE(set.joints[1].parts.empty());
  EXPECT_EQ(body.toml, kSmall);
  EXPECT_EQ(body.find_part("r_arm"), 2);
  EXPECT_EQ(body.find_part("r_ar"), -1);
}

constexpr const char* kDistribution = R"(
[distribution]
factors = 2
noise = 0.04
confidence = [-3.5, -1.5]
[[distribution.part]]
name = "trunk"
mean = [0.1, 0.2, 0.3]
residual = 0.05
x = [1.0, 2.0]
y = [3.0, 4.0]
z = [5.0, 6.0]
[[distribution.part]]
name = "l_arm"
mean = [0.0, 0.0, 0.0]
residual = 0.0
x = [0.0, 0.0]
y = [0.0, 0.0]
z = [0.0, 0.0]
[[distribution.part]]
name = "r_arm"
mean = [0.0, 0.0, 0.0]
residual = 0.0
x = [0.0, 0.0]
y = [0.0, 0.0]
z = [0.0, 0.0]
)";

TEST(BodyModel, HasTheDistributionOfItsParts) {
  const PartDistribution d = parse_body_model(std::string(kSmall) + kDistribution, "b").distribution;
  EXPECT_EQ(d.factors, 2);
  EXPECT_FLOAT_EQ(d.noise_m, 0.04F);
  EXPECT_FLOAT_EQ(d.confidence.bias, -3.5F);
  EXPECT_FLOAT_EQ(d.confidence.slope, -1.5F);
  EXPECT_FALSE(d.voted_confidence);
  ASSERT_EQ(d.parts.size(), 3U);
  EXPECT_FLOAT_EQ(d.parts[0].mean_m[2], 0.3F);
  EXPECT_FLOAT_EQ(d.parts[0].residual_m, 0.05F);
  EXPECT_EQ(d.parts[0].factors_m[1], (std::vector<float>{3.F, 4.F}));
  EXPECT_TRUE(parse_body_model(kSmall, "b").distribution.parts.empty());
}

TEST(BodyModel, HasWhatVotesForPartsNeed) {
  std::string text = std::string(kSmall) + kDistribution;
  text.insert(text.find("confidence"), "voted_confidence = [-8.5, -2.5]\n");
  text.insert(text.find("residual = 0.05"), "depth = 0.07\nobserved = 0.16\n");
  const PartDistribution d = parse_body_model(text, "b").distribution;
  ASSERT_TRUE(d.voted_confidence);
  EXPECT_FLOAT_EQ(d.voted_confidence->bias, -8.5F);
  EXPECT_FLOAT_EQ(d.voted_confidence->slope, -2.5F);
  EXPECT_FLOAT_EQ(d.parts[0].depth_m, 0.07F);
  EXPECT_FLOAT_EQ(d.parts[0].observed_m, 0.16F);
  EXPECT_FLOAT_EQ(d.parts[1].depth_m, 0.F);
  EXPECT_FLOAT_EQ(d.parts[1].observed_m, 0.F);
}

TEST(BodyModel, RefusesADistributionOfOtherParts) {
  const auto expect = [](const std::string& from, const std::string& to, const std::string& message) {
    std::string text = kDistribution;
    text.replace(text.find(from), from.size(), to);
    EXPECT_THAT([&] { parse_body_model(kSmall + text, "b"); }, ThrowsMessage<Error>(HasSubstr(message)));
  };
  expect("l_arm", "r_arm", "name: expected \"l_arm\", parts in the body's order");
  expect("[3.0, 4.0]", "[3.0]", "y: expected 2 numbers, found 1");
  expect("factors = 2", "factors = -1", "factors: expected");
  expect("[0.1, 0.2, 0.3]", "[0.1, 0.2, 30.0]", "mean: expected a number from -10 to 10");
}

TEST(BodyModel, ContainsThePaperBodyOfTheRepository) {
  std::ifstream file(std::string(VESALIUS_SOURCE_DIR) + "/data/bodies/paper25.toml");
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_EQ(paper_body().toml, text.str());
}

TEST(BodyModel, NumbersThePaperBodyAsTheReleasedTreesDo) {
  const BodyModel& body = paper_body();
  ASSERT_EQ(body.part_count(), 25);
  EXPECT_EQ(body.find_part("l_foot"), 0);
  EXPECT_EQ(body.find_part("r_hips"), 8);
  EXPECT_EQ(body.find_part("neck"), 10);
  EXPECT_EQ(body.find_part("r_hand"), 14);
  EXPECT_EQ(body.find_part("l_hand"), 18);
  EXPECT_EQ(body.find_part("l_chest"), 24);
  EXPECT_EQ(body.links.size(), 24U);
  std::vector<std::string> sets;
  for (const JointSet& set : body.joint_sets) {
    sets.push_back(set.name + ":" + std::to_string(set.joints.size()));
  }
  EXPECT_THAT(sets, testing::ElementsAre("nite15:15", "k4abt32:32", "coco17:17"));
  const auto upper = std::ranges::count_if(body.parts, &BodyPart::upper_body);
  EXPECT_EQ(upper, 17);
}

TEST(BodyModel, MirrorsThePaperBodyOntoItself) {
  const BodyModel& body = paper_body();
  const auto mirrored = [&](int part) { return body.parts[part].mirror; };
  std::set<std::pair<int, int>> links;
  for (const BodyLink& link : body.links) links.emplace(link.parent, link.child);
  for (const BodyLink& link : body.links) {
    EXPECT_TRUE(links.contains({mirrored(link.parent), mirrored(link.child)})) << body.parts[link.child].name;
  }
  for (const BodyPart& part : body.parts) {
    if (part.name.starts_with("l_")) {
      EXPECT_EQ(body.parts[part.mirror].name, std::string(part.name).replace(0, 2, "r_"));
    }
  }
}

const std::string kSurface = R"([[surface]]
part = "l_arm"
bone = "l_forearm"
from = 0.25
to = 1
[[surface]]
part = "trunk"
bone = "chest"
from = 0
to = 0.5
side = "left"
)";

TEST(BodyModel, ReadsSurfaceRules) {
  const BodyModel body = parse_body_model(kSmall + kSurface, "small.toml");
  ASSERT_EQ(body.surface.size(), 2U);
  EXPECT_EQ(body.surface[0].part, 1);
  EXPECT_EQ(body.surface[0].bone, "l_forearm");
  EXPECT_EQ(body.surface[0].from, 0.25F);
  EXPECT_EQ(body.surface[0].to, 1.F);
  EXPECT_EQ(body.surface[0].side, SurfaceRule::Side::both);
  EXPECT_EQ(body.surface[1].side, SurfaceRule::Side::left);
  EXPECT_EQ(body.surface[1].line, 49);
  EXPECT_TRUE(parse_body_model(kSmall, "small.toml").surface.empty());
}

TEST(BodyModel, NamesTheLineOfABadSurfaceRule) {
  const auto expect = [](const std::string& from, const std::string& to, const std::string& message) {
    std::string text = kSmall + kSurface;
    const std::size_t at = text.find(from, text.find("[[surface]]"));
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
    EXPECT_THAT([&] { parse_body_model(text, "b"); }, ThrowsMessage<Error>(StartsWith(message))) << to;
  };
  expect("l_arm", "l_leg", "b:45: part: no part is called \"l_leg\"");
  expect("0.25", "-0.25", "b:47: from: expected a number from 0 to 1");
  expect("to = 1", "to = 0.25", "b:44: surface: expected \"to\" to be larger than \"from\"");
  expect("\"left\"", "\"west\"", "b:54: side \"west\": expected \"both\", \"left\" or \"right\"");
  expect("side =", "sides =", "b:54: unknown key \"sides\"");
  expect("bone = \"chest\"\n", "", "b:49: missing key \"bone\"");
}

TEST(BodyModel, HasASurfaceRuleForEveryPartOfThePaperBody) {
  const BodyModel& body = paper_body();
  std::set<int> parts;
  for (const SurfaceRule& rule : body.surface) parts.insert(rule.part);
  EXPECT_EQ(parts.size(), 25U);
}

std::string without_last_link() {
  std::string text = kSmall;
  const std::size_t at = text.rfind("[[link]]");
  return text.erase(at, text.find("[[joint_set]]") - at);
}

struct Bad {
  const char* why;
  std::string text;
  const char* message;  ///< after "b.toml:"
};

class BadBody : public testing::TestWithParam<Bad> {};

TEST_P(BadBody, IsRefusedWithLineAndReason) {
  EXPECT_THAT([] { parse_body_model(GetParam().text, "b.toml"); },
              ThrowsMessage<Error>(StartsWith(std::string("b.toml:") + GetParam().message)));
}

std::string many_parts(int count) {
  std::ostringstream text;
  text << "name = \"m\"\nroots = [\"p0\"]\n";
  for (int i = 0; i < count; ++i) {
    text << "[[part]]\nname = \"p" << i << "\"\ncolour = [0,0,0]\nmirror = \"p" << i
         << "\"\nmax_extent = 1\narea = 1\nupper_body = true\n";
    if (i > 0) text << "[[link]]\nparent = \"p0\"\nchild = \"p" << i << "\"\nlength = 1\ntolerance = 1\n";
  }
  return text.str();
}

INSTANTIATE_TEST_SUITE_P(
    All, BadBody,
    testing::Values(
        Bad{"empty", "", "1: missing key \"name\""}, Bad{"no_toml", "name = \"x\"\nparts {", "2: not valid TOML"},
        Bad{"unknown_key", changed("area", "size"), "8: unknown key \"size\", expected name, colour"},
        Bad{"missing_key", changed("area = 0.1\n", ""), "3: missing key \"area\""},
        Bad{"up_offset", changed("depth_offset = 0.05", "depth_offset = 0.05\nup_offset = 2"),
            "41: up_offset: expected"},
        Bad{"name_type", changed("\"trunk\"\ncolour", "7\ncolour"), "4: name: expected a string"},
        Bad{"name_empty", changed("\"l_arm\"", "\"\""), "11: name \"\": expected 1 to 64"},
        Bad{"name_path", changed("\"l_arm\"", "\"../x\""), "11: name \"../x\": expected 1 to 64"},
        Bad{"name_control", changed("\"l_arm\"", "\"a\\nb\""), "11: name \"a?b\": expected 1 to 64"},
        Bad{"same_name", changed("\"r_arm\"\ncolour", "\"l_arm\"\ncolour"),
            "17: part: the name \"l_arm\" is used twice"},
        Bad{"colour_range", changed("[4, 5, 6]", "[4, 5, 256]"), "12: colour: expected a whole number from 0 to 255"},
        Bad{"colour_negative", changed("[4, 5, 6]", "[-1, 5, 6]"), "12: colour: expected a whole number from 0 to 255"},
        Bad{"colour_real", changed("[4, 5, 6]", "[4.5, 5, 6]"), "12: colour: expected a whole number from 0 to 255"},
        Bad{"colour_count", changed("[4, 5, 6]", "[4, 5]"), "12: colour: expected 3 whole numbers"},
        Bad{"extent_zero", changed("max_extent = 1", "max_extent = 0"), "7: max_extent: expected a number from"},
        Bad{"extent_nan", changed("max_extent = 1", "max_extent = nan"), "7: max_extent: expected a number from"},
        Bad{"extent_text", changed("max_extent = 1", "max_extent = \"1\""), "7: max_extent: expected a number from"},
        Bad{"area_negative", changed("area = 0.1", "area = -0.1"), "8: area: expected a number from"},
        Bad{"upper_type", changed("upper_body = true", "upper_body = 1"), "9: upper_body: expected true or false"},
        Bad{"mirror_unknown", changed("mirror = \"r_arm\"", "mirror = \"x\""), "13: mirror: no part is called \"x\""},
        Bad{"mirror_one_way", changed("mirror = \"r_arm\"", "mirror = \"trunk\""),
            "10: part \"l_arm\": its mirror \"trunk\" does not name it"},
        Bad{"link_unknown", changed("child = \"l_arm\"", "child = \"x\""), "26: child: no part is called \"x\""},
        Bad{"link_self", changed("child = \"l_arm\"", "child = \"trunk\""), "24: link: \"trunk\" cannot be its own"},
        Bad{"link_twice", changed("child = \"l_arm\"", "child = \"r_arm\""), "29: link: \"r_arm\" has a second parent"},
        Bad{"link_missing", without_last_link(), "24: link: expected 2 links, one tree over all parts, found 1"},
        Bad{"link_length", changed("length = 0.3", "length = inf"), "27: length: expected a number from"},
        Bad{"link_tolerance", changed("tolerance = 0.15", "tolerance = 0"), "28: tolerance: expected a number from"},
        Bad{"roots_unknown", changed("[\"trunk\"]", "[\"x\"]"), "2: roots: no part is called \"x\""},
        Bad{"roots_twice", changed("[\"trunk\"]", "[\"trunk\", \"trunk\"]"), "2: roots: \"trunk\" is listed twice"},
        Bad{"roots_empty", changed("[\"trunk\"]", "[]"), "2: roots: expected at least one part"},
        Bad{"joint_part", changed("[\"l_arm\", \"r_arm\"]", "[\"l_arm\", \"x\"]"),
            "38: parts: no part is called \"x\""},
        Bad{"weight_count", changed("[0.25, 0.75]", "[1.0]"), "39: weights: expected as many as parts, 2, found 1"},
        Bad{"weight_sum", changed("[0.25, 0.75]", "[0.25, 0.7]"), "39: weights: expected a sum of 1"},
        Bad{"joint_name", changed("\"tail\"", "\"between\""),
            "41: joint_set \"two\": the joint \"between\" is used twice"},
        Bad{"no_parts", "name = \"x\"\nroots = []\npart = []\n", "3: part: expected 1 to 200 parts, found 0"},
        Bad{"parts_no_array", "name = \"x\"\nroots = []\npart = 3\n", "3: part: expected an array"},
        Bad{"part_no_table", "name = \"x\"\nroots = []\npart = [3]\n", "3: part: expected a table"},
        Bad{"too_many", many_parts(201), "3: part: expected 1 to 200 parts, found 201"}),
    [](const auto& param_info) { return std::string(param_info.param.why); });

TEST(BodyModel, RefusesLinksInARing) {
  // Here l_arm and r_arm are linked to each other, and the trunk to nothing.
  std::string text = changed("parent = \"trunk\"", "parent = \"r_arm\"");
  const std::size_t second = text.rfind("parent = \"trunk\"");
  text.replace(second, 16, "parent = \"l_arm\"");
  EXPECT_THAT([&] { parse_body_model(text, "b.toml"); },
              ThrowsMessage<Error>(AllOf(StartsWith("b.toml:24:"), HasSubstr("hangs in a ring"))));
}

TEST(BodyModel, HoldsFromOneTo200Parts) {
  EXPECT_EQ(parse_body_model(many_parts(1), "one").part_count(), 1);
  EXPECT_EQ(parse_body_model(many_parts(200), "most").part_count(), 200);
}

TEST(BodyModel, ReadsOrRefusesAnyPrefixOfItsText) {
  const std::string text = paper_body().toml;
  for (std::size_t n = 0; n < text.size(); n += 97) {
    try {
      parse_body_model(std::string_view(text).substr(0, n), "cut");
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), StartsWith("cut:"));
    }
  }
}

TEST(ParseBodyModel, RefusesAnEndlessKey) {
  std::string endless = "name = \"x\"\na";
  for (int i = 0; i < 100000; ++i) endless += ".a";
  EXPECT_THAT([&] { parse_body_model(endless + " = 1\n", "b.toml"); },
              ThrowsMessage<Error>("b.toml:2: line of 200005 characters, expected at most 4096"));
}

BodyModel with_sets() {
  BodyModel body;
  body.joint_sets = {{"nite15", {}}, {"k4abt32", {}}};
  return body;
}

TEST(FindJointSet, GivesItsIndex) {
  EXPECT_EQ(find_joint_set(with_sets(), "nite15"), 0U);
  EXPECT_EQ(find_joint_set(with_sets(), "k4abt32"), 1U);
}

TEST(FindJointSet, NamesThoseThatThereAre) {
  EXPECT_THAT(([] { find_joint_set(with_sets(), "feet"); }),
              ThrowsMessage<UsageError>("joint set \"feet\" is not of this body, expected one of: nite15, k4abt32"));
}

}  // namespace
}  // namespace vesalius
