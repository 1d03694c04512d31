#include "vesalius/fit/flesh_joints.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <numbers>
#include <sstream>

#include "vesalius/error.h"
#include "vesalius/fit/test_bad_toml.h"
#include "vesalius/fit/test_flesh.h"

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
  hand.of_head.log_sigma = -3.F;
  hand.of_tail.log_sigma = -1.F;
  BodyTrust trust;
  trust.predicted = {0.5F, {.log_sigma = -1.F}};
  std::vector<std::vector<Joint>> joints;
  for (const JointSet& each : body.joint_sets) {
    joints.emplace_back(each.joints.size(), Joint{State::observed, {7.F, 8.F, 9.F}, 0.5F});
  }
  place_joints(fitted, parse_flesh_joints(kSmall, "small", flesh), body, trust, joints);
  const auto joint_of = [&](const char* name) {
    const auto joint = std::ranges::find(set->joints, name, &JointDefinition::name);
    EXPECT_NE(joint, set->joints.end()) << name;
    return joints[at][static_cast<std::size_t>(joint - set->joints.begin())];
  };
  const Joint placed = joint_of("l_hand");
  // 0.1 m down from (1, 0, 2); the offset turned is (-0.02, 0.01, 0.03).
  EXPECT_LT((placed.position - Eigen::Vector3f(0.98F, 0.11F, 2.03F)).norm(), 1e-5F);
  EXPECT_EQ(placed.state, State::predicted);
  // A quarter of the way along: log sigma -2.5, logit 3.
  EXPECT_NEAR(placed.confidence, 1.F / (1.F + std::exp(-3.F)), 1e-6F);
  // Those without a place in the flesh stay as they were.
  EXPECT_EQ(joint_of("l_knee").position, Eigen::Vector3f(7.F, 8.F, 9.F));
  EXPECT_EQ(joint_of("l_knee").state, State::observed);
}

constexpr double kRightAngle = std::numbers::pi / 2.0;

/// Returns the body at rest: a T, upright, which faces the camera at yaw 0.
BodyState at_rest(double yaw_rad = 0.0) {
  const FleshModel& flesh = builtin_flesh();
  BodyState state{{0.0, 0.0, 2.5},
                  std::vector<Eigen::Quaterniond>(flesh.bones.size(), Eigen::Quaterniond::Identity()),
                  Eigen::VectorXd::Zero(flesh.shapes)};
  state.local[0] = test::upright(yaw_rad);
  return state;
}

FittedBody fitted_as(const BodyState& state) {
  FittedBody fitted;
  for (const PlacedBone& placed : place_bones(builtin_flesh(), state)) {
    FittedBone& bone = fitted.bones.emplace_back();
    bone.state = State::observed;
    bone.head = placed.head.cast<float>();
    bone.tail = placed.tail.cast<float>();
    bone.global = Eigen::Quaternionf(placed.global.cast<float>());
  }
  return fitted;
}

const JointSet& k4abt() { return *std::ranges::find(paper_body().joint_sets, "k4abt32", &JointSet::name); }

/// Returns the rotations of the joints of Azure Kinect's set that have one.
std::map<std::string, Eigen::Matrix3f> k4abt_rotations(const FittedBody& fitted) {
  std::map<std::string, Eigen::Matrix3f> by_name;
  const auto rotations = joint_rotations(fitted, builtin_flesh_joints(), k4abt());
  for (std::size_t j = 0; j < rotations.size(); ++j) {
    if (rotations[j]) by_name[k4abt().joints[j].name] = rotations[j]->toRotationMatrix();
  }
  return by_name;
}

TEST(JointRotations, AreThoseOfTheAzureKinectForATBeforeTheCamera) {
  const Eigen::Vector3f left(1.F, 0.F, 0.F), up(0.F, -1.F, 0.F), front(0.F, 0.F, -1.F);
  const std::map<std::string, std::array<Eigen::Vector3f, 3>> axes = {
      {"pelvis", {up, front, left}},      {"spine_naval", {up, front, left}}, {"spine_chest", {up, front, left}},
      {"neck", {up, front, left}},        {"head", {up, front, left}},        {"nose", {up, front, left}},
      {"l_clavicle", {left, front, -up}}, {"r_clavicle", {left, -front, up}}, {"l_shoulder", {left, front, -up}},
      {"r_shoulder", {left, -front, up}}, {"l_elbow", {left, front, -up}},    {"r_elbow", {left, -front, up}},
      {"l_wrist", {left, up, front}},     {"r_wrist", {left, -up, -front}},   {"l_hand", {left, up, front}},
      {"r_hand", {left, -up, -front}},    {"l_handtip", {left, up, front}},   {"r_handtip", {left, -up, -front}},
      {"l_hip", {up, front, left}},       {"r_hip", {-up, -front, left}},     {"l_knee", {up, front, left}},
      {"r_knee", {-up, -front, left}},    {"l_ankle", {up, front, left}},     {"r_ankle", {-up, -front, left}},
      {"l_foot", {front, -up, left}},     {"r_foot", {-front, up, left}},     {"l_eye", {front, -up, left}},
      {"r_eye", {front, -up, left}},      {"l_ear", {-up, -front, left}},     {"r_ear", {up, front, left}},
  };
  const auto rotations = k4abt_rotations(fitted_as(at_rest()));
  EXPECT_EQ(rotations.size(), axes.size());
  for (const auto& [name, expected] : axes) {
    ASSERT_TRUE(rotations.contains(name)) << name;
    for (int i = 0; i < 3; ++i) {
      // The bones of the trunk and the hands do not lie on the axes at rest, by up to 20 degrees.
      EXPECT_GT(rotations.at(name).col(i).dot(expected[static_cast<std::size_t>(i)]), 0.93F) << name << " axis " << i;
    }
  }
  // The thigh hangs straight down. What the tracker's own interface calls w, x, y, z is then (1, -1, 1, -1) / 2.
  const Eigen::Quaternionf hip(rotations.at("l_hip"));
  EXPECT_NEAR(std::abs(hip.dot(Eigen::Quaternionf(0.5F, -0.5F, 0.5F, -0.5F))), 1.F, 1e-5F);
}

TEST(JointRotations, HaveTheirXAxesOnTheBones) {
  const FleshModel& flesh = builtin_flesh();
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const FittedBody fitted = fitted_as(test::random_state(seed, 0.4));
    const auto rotations = k4abt_rotations(fitted);
    const auto expect_on = [&](const char* joint, const char* name, float side) {
      const FittedBone& bone = fitted.bones[flesh.find_bone(name)];
      const Eigen::Vector3f line = (bone.tail - bone.head).normalized();
      EXPECT_NEAR(rotations.at(joint).col(0).dot(line), side, 1e-4F) << joint;
    };
    expect_on("pelvis", "pelvis", 1.F), expect_on("spine_naval", "spine", 1.F), expect_on("spine_chest", "chest", 1.F);
    expect_on("neck", "neck", 1.F);
    expect_on("l_clavicle", "l_clavicle", 1.F), expect_on("r_clavicle", "r_clavicle", -1.F);
    expect_on("l_shoulder", "l_upper_arm", 1.F), expect_on("r_shoulder", "r_upper_arm", -1.F);
    expect_on("l_elbow", "l_forearm", 1.F), expect_on("r_elbow", "r_forearm", -1.F);
    expect_on("l_hand", "l_hand", 1.F), expect_on("r_hand", "r_hand", -1.F);
    expect_on("l_hip", "l_thigh", -1.F), expect_on("r_hip", "r_thigh", 1.F);
    expect_on("l_knee", "l_shin", -1.F), expect_on("r_knee", "r_shin", 1.F);
  }
}

TEST(JointRotations, OfAnElbowBentForwardsTurnAboutZByTheSameAngleOnBothSides) {
  BodyState state = at_rest();
  test::turn(state, "l_forearm", {0.0, -kRightAngle, 0.0});
  test::turn(state, "r_forearm", {0.0, kRightAngle, 0.0});
  test::turn(state, "l_shin", {kRightAngle, 0.0, 0.0});
  test::turn(state, "r_shin", {kRightAngle, 0.0, 0.0});
  const auto rotations = k4abt_rotations(fitted_as(state));
  // Forearms point at the camera: x to the hand on the left, from it on the right.
  EXPECT_LT((rotations.at("l_elbow").col(0) - Eigen::Vector3f(0.F, 0.F, -1.F)).norm(), 0.02F);
  EXPECT_LT((rotations.at("r_elbow").col(0) - Eigen::Vector3f(0.F, 0.F, 1.F)).norm(), 0.02F);
  const auto turned = [&](const char* from, const char* to) -> Eigen::Vector3d {
    const Eigen::Matrix3d by = (rotations.at(from).transpose() * rotations.at(to)).cast<double>();
    return log_rotation(Eigen::Quaterniond(by));
  };
  for (const auto& [from, to] :
       {std::pair{"l_shoulder", "l_elbow"}, {"r_shoulder", "r_elbow"}, {"l_hip", "l_knee"}, {"r_hip", "r_knee"}}) {
    EXPECT_LT((turned(from, to) - Eigen::Vector3d(0.0, 0.0, kRightAngle)).norm(), 0.05) << to;
  }
}

TEST(JointRotations, TurnWithTheBody) {
  const auto facing = k4abt_rotations(fitted_as(at_rest()));
  const auto turned = k4abt_rotations(fitted_as(at_rest(kRightAngle)));
  // A quarter turn of the person to the left turns the picture's right to the camera.
  const Eigen::Matrix3f quarter =
      Eigen::AngleAxisf(-static_cast<float>(kRightAngle), Eigen::Vector3f::UnitY()).toRotationMatrix();
  for (const auto& [name, rotation] : facing) {
    EXPECT_LT((turned.at(name) - quarter * rotation).norm(), 1e-4F) << name;
  }
  EXPECT_GT(turned.at("pelvis").col(1).x(), 0.93F) << "who turns to the left looks to the right of the picture";
}

TEST(JointRotations, OfTheRightSideAreTheMirrorImageReversed) {
  const FleshModel& flesh = builtin_flesh();
  BodyState state = at_rest();
  Random random(3);
  for (std::size_t b = 1; b < flesh.bones.size(); ++b) {
    const std::string& name = flesh.bones[b].name;
    if (!name.starts_with("l_")) continue;
    const double x = random.normal(0.0, 0.5), y = random.normal(0.0, 0.5), z = random.normal(0.0, 0.5);
    test::turn(state, name.c_str(), {x, y, z});
    test::turn(state, ("r" + name.substr(1)).c_str(), {x, -y, -z});
  }
  const auto rotations = k4abt_rotations(fitted_as(state));
  const Eigen::Matrix3f mirror = Eigen::Vector3f(-1.F, 1.F, 1.F).asDiagonal();
  int pairs = 0;
  for (const auto& [name, left] : rotations) {
    if (!name.starts_with("l_") || name == "l_eye") continue;
    EXPECT_LT((rotations.at("r" + name.substr(1)) + mirror * left).norm(), 1e-4F) << name;
    ++pairs;
  }
  EXPECT_EQ(pairs, 11);
}

TEST(JointRotations, AreNotInventedWhereNothingIsKnown) {
  FittedBody fitted = fitted_as(at_rest());
  fitted.bones[builtin_flesh().find_bone("l_hand")].state = State::none;
  const auto rotations = k4abt_rotations(fitted);
  for (const char* name : {"l_wrist", "l_hand", "l_handtip", "l_thumb", "r_thumb"}) {
    EXPECT_FALSE(rotations.contains(name)) << name;
  }
  const auto set = std::ranges::find(paper_body().joint_sets, "nite15", &JointSet::name);
  for (const auto& rotation : joint_rotations(fitted, builtin_flesh_joints(), *set)) EXPECT_FALSE(rotation);
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
          test::BadToml{"along = 0.5", "along = 0.5\naxes = [\"+x\", \"+y\"]", 7, "axes: expected three axes"},
          test::BadToml{"along = 0.5", "along = 0.5\naxes = [\"+x\", \"+y\", \"-z\"]", 7, "right-handed"},
          test::BadToml{"along = 0.5", "along = 0.5\naxes = [\"+x\", \"+x\", \"+z\"]", 7, "right-handed"},
          test::BadToml{"along = 0.5", "along = 0.5\naxes = [\"+x\", \"up\", \"+z\"]", 7, "right-handed"},
          test::BadToml{"along = 0.5", "along = 0.5\nx_on_bone = 1", 7, "x_on_bone"},
      },
      [](const std::string& text, const char* name) { parse_flesh_joints(text, name, builtin_flesh()); });
}

}  // namespace
}  // namespace vesalius
