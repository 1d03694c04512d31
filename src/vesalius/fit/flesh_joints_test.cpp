#include "vesalius/fit/flesh_joints.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <numbers>
#include <sstream>

#include "vesalius/base/error.h"
#include "vesalius/fit/test_bad_toml.h"

namespace vesalius {
namespace {

// The tests depend on its line numbers.
constexpr const char* kSmall = R"([[joint_set]]
name = "nite15"
[[joint_set.joint]]
name = "head"
bone = "head"
along = 0.5
[[joint_set.joint]]
name = "l_hand"
bone = "l_hand"
along = 0.25
offset = [0.01, 0.02, 0.03]
)";

TEST(FleshJoints, AreReadWithTheirMirrorImages) {
  const FleshModel& flesh = builtin_flesh();
  const std::vector<FleshJoint> joints = parse_flesh_joints(kSmall, "small", flesh);
  ASSERT_EQ(joints.size(), 3U);
  EXPECT_EQ(joints[0].bone, flesh.find_bone("head"));
  EXPECT_EQ(joints[2].set, "nite15");
  EXPECT_EQ(joints[2].name, "r_hand");
  EXPECT_EQ(joints[2].bone, flesh.find_bone("r_hand"));
  EXPECT_EQ(joints[2].along, 0.25F);
  EXPECT_EQ(joints[2].offset_m, Eigen::Vector3f(-0.01F, 0.02F, 0.03F));
}

/// Returns the joint sets of the body models that come with the program.
std::vector<JointSet> program_joint_sets() {
  std::vector<JointSet> sets = paper_body().joint_sets;
  const std::string path = std::string(VESALIUS_SOURCE_DIR) + "/data/bodies/upper_body.toml";
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  std::ranges::copy(parse_body_model(text.str(), path).joint_sets, std::back_inserter(sets));
  return sets;
}

TEST(FleshJoints, OfTheProgramAreJointsOfItsBodies) {
  const std::vector<JointSet> sets = program_joint_sets();
  for (const FleshJoint& joint : builtin_flesh_joints()) {
    if (std::ranges::find(sets, joint.set, &JointSet::name) == sets.end())
      continue;  // of evaluation (data/joints/evaluation.toml)
    EXPECT_TRUE(std::ranges::any_of(sets,
                                    [&](const JointSet& set) {
                                      return set.name == joint.set &&
                                             std::ranges::find(set.joints, joint.name, &JointDefinition::name) !=
                                                 set.joints.end();
                                    }))
        << joint.set << " " << joint.name;
  }
}

TEST(FleshJoints, OfTheAzureKinectAreAllButTheThumbs) {
  const auto set = std::ranges::find(paper_body().joint_sets, "k4abt32", &JointSet::name);
  ASSERT_NE(set, paper_body().joint_sets.end());
  std::vector<std::string> without;
  for (const JointDefinition& joint : set->joints) {
    const bool given = std::ranges::any_of(builtin_flesh_joints(), [&](const FleshJoint& place) {
      return place.set == set->name && place.name == joint.name;
    });
    if (!given) without.push_back(joint.name);
  }
  EXPECT_THAT(without, testing::UnorderedElementsAre("l_thumb", "r_thumb"));
}

TEST(FleshJoints, LieWhereTheirBonesAre) {
  const FleshModel& flesh = builtin_flesh();
  const BodyModel& body = paper_body();
  const auto set = std::ranges::find(body.joint_sets, "nite15", &JointSet::name);
  ASSERT_NE(set, body.joint_sets.end());
  const auto at = static_cast<std::size_t>(set - body.joint_sets.begin());
  FittedBody fitted;
  fitted.bones.resize(flesh.bones.size());
  FittedBone& hand = fitted.bones[flesh.find_bone("l_hand")];
  hand.head = {1.F, 0.F, 2.F};
  hand.tail = {1.F, 0.4F, 2.F};
  // A quarter turn about z takes x to y: the hand points down in the picture.
  hand.global = Eigen::AngleAxisf(static_cast<float>(std::numbers::pi) / 2.F, Eigen::Vector3f::UnitZ());
  hand.state = State::predicted;
  hand.confidence = 0.8F;
  hand.tail_confidence = 0.4F;
  std::vector<std::vector<Joint>> joints;
  for (const JointSet& each : body.joint_sets) {
    joints.emplace_back(each.joints.size(), Joint{State::observed, {7.F, 8.F, 9.F}, 0.5F});
  }
  place_joints(fitted, parse_flesh_joints(kSmall, "small", flesh), body, joints);
  const auto joint_of = [&](const char* name) {
    const auto joint = std::ranges::find(set->joints, name, &JointDefinition::name);
    EXPECT_NE(joint, set->joints.end()) << name;
    return joints[at][static_cast<std::size_t>(joint - set->joints.begin())];
  };
  const Joint placed = joint_of("l_hand");
  // 0.1 m down from (1, 0, 2); the offset turned is (-0.02, 0.01, 0.03).
  EXPECT_LT((placed.position - Eigen::Vector3f(0.98F, 0.11F, 2.03F)).norm(), 1e-5F);
  EXPECT_EQ(placed.state, State::predicted);
  EXPECT_NEAR(placed.confidence, 0.7F, 1e-5F);
  // Those without a place in the flesh stay as they were.
  EXPECT_EQ(joint_of("l_knee").position, Eigen::Vector3f(7.F, 8.F, 9.F));
  EXPECT_EQ(joint_of("l_knee").state, State::observed);
}

TEST(FleshJoints, ErrorsNameFileLineAndExpectation) {
  test::expect_refused(
      kSmall,
      {
          test::BadToml{"bone = \"head\"", "bone = \"tail\"", 3, "\"tail\": expected a bone of the flesh"},
          test::BadToml{"along = 0.5", "along = 11", 6, "along"},
          test::BadToml{"along = 0.5", "along = nan", 6, "along"},
          test::BadToml{"along = 0.5", "", 3, "missing key \"along\""},
          test::BadToml{"offset = [0.01, 0.02, 0.03]", "offset = [0.01, 0.02]", 11, "expected 3 numbers"},
          test::BadToml{"offset = [0.01, 0.02, 0.03]", "offset = [0.01, 0.02, \"a\"]", 11, "offset"},
          test::BadToml{"offset", "offsets", 11, "unknown key"},
          test::BadToml{"name = \"head\"", "name = 1", 4, "expected a string"},
      },
      [](const std::string& text, const char* name) { parse_flesh_joints(text, name, builtin_flesh()); });
}

}  // namespace
}  // namespace vesalius
