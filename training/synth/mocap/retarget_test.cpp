#include "synth/mocap/retarget.h"

#include <gmock/gmock.h>

#include "synth/text/test_text.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr float kPi = 3.14159265F;

Eigen::Quaternionf turn(float degrees, const Eigen::Vector3f& axis) {
  return Eigen::Quaternionf(Eigen::AngleAxisf(degrees * kPi / 180.F, axis));
}

/// Returns a convention with one joint for each bone, of the same name. Bones with RestRule::aim point along the T
/// turned by 20 degrees about z.
std::string toml(const std::string& extra = "") {
  std::string text = "name = \"t\"\nskip_frames = 1\n[bones]\n";
  for (int b = 0; b < kBoneCount; ++b) {
    const std::string name(bone_name(static_cast<Bone>(b)));
    const bool aims = name.find("thigh") != std::string::npos;
    text += name + " = { from = [\"" + name + "\"], rest = \"" + (aims ? "aim" : "same") + "\" }\n";
  }
  return text + extra;
}

Motion still_motion(int frames) {
  Motion motion;
  motion.name = "m";
  motion.fps = 30.F;
  for (int b = 0; b < kBoneCount; ++b) {
    const auto bone = static_cast<Bone>(b);
    motion.joints.push_back({std::string(bone_name(bone)), b == 0 ? -1 : index(parent(bone)), Eigen::Vector3f::Zero(),
                             turn(20.F, Eigen::Vector3f::UnitZ()) * rest_direction(bone)});
  }
  motion.world.assign(static_cast<std::size_t>(frames * kBoneCount), Eigen::Quaternionf::Identity());
  motion.root.assign(static_cast<std::size_t>(frames), Eigen::Vector3f::Zero());
  return motion;
}

Eigen::Vector3f direction(const Pose& pose, Bone bone) {
  return world_rotations(pose)[index(bone)] * rest_direction(bone);
}

auto parsing(const std::string& text) {
  return [text] { parse_convention(text, "c.toml"); };
}

TEST(Retarget, PointsBonesWhereTheMotionDoes) {
  Motion motion = still_motion(3);
  const Eigen::Quaternionf thigh = turn(-70.F, Eigen::Vector3f::UnitX());
  motion.world[2 * kBoneCount + index(Bone::l_thigh)] = thigh;
  const std::vector<Pose> poses = retarget(motion, parse_convention(toml(), "c.toml"));
  ASSERT_EQ(poses.size(), 2U) << "the first frame is skipped";
  EXPECT_TRUE(direction(poses[0], Bone::l_thigh).isApprox(motion.joints[index(Bone::l_thigh)].along, 1e-5F));
  EXPECT_TRUE(direction(poses[1], Bone::l_thigh).isApprox(thigh * motion.joints[index(Bone::l_thigh)].along, 1e-5F));
  EXPECT_TRUE(direction(poses[0], Bone::l_upper_arm).isApprox(Eigen::Vector3f::UnitX(), 1e-5F)) << "rest: same";
}

TEST(Retarget, TakesAnotherBonesTurnAndTheMeanOfTwoJoints) {
  std::string text = replaced(toml(), "[\"l_shin\"], rest = \"same\"", "[\"l_shin\"], rest = \"l_thigh\"");
  text = replaced(text, "from = [\"neck\"]", "from = [\"neck\", \"head\"]");
  Motion motion = still_motion(2);
  motion.world[kBoneCount + index(Bone::head)] = turn(60.F, Eigen::Vector3f::UnitX());
  const Pose pose = retarget(motion, parse_convention(text, "c.toml"))[0];
  EXPECT_TRUE(direction(pose, Bone::l_shin).isApprox(direction(pose, Bone::l_thigh), 1e-5F));
  EXPECT_NEAR(pose[Bone::neck].angularDistance(Eigen::Quaternionf::Identity()), kPi / 6, 1e-4F);
}

TEST(Retarget, RemovesTheHeadingAndKeepsTheTilt) {
  Motion motion = still_motion(2);
  const Eigen::Quaternionf tilt = turn(40.F, Eigen::Vector3f::UnitX()), heading = turn(130.F, Eigen::Vector3f::UnitY());
  for (int b = 0; b < kBoneCount; ++b) motion.world[kBoneCount + b] = heading * tilt;
  const Pose pose = retarget(motion, parse_convention(toml(), "c.toml"))[0];
  EXPECT_LT(pose[Bone::pelvis].angularDistance(tilt), 1e-3F);
  EXPECT_LT(pose[Bone::head].angularDistance(Eigen::Quaternionf::Identity()), 1e-3F);
}

TEST(Retarget, RefusesMotionsThatDoNotFit) {
  Motion motion = still_motion(2);
  const MotionConvention convention = parse_convention(toml(), "c.toml");
  motion.joints[index(Bone::l_thigh)].along.setZero();
  EXPECT_THAT([&] { retarget(motion, convention); },
              ThrowsMessage<Error>("m: joint \"l_thigh\" has no direction: expected a child apart from it"));
  motion.joints[0].name = "Hips";
  EXPECT_THAT([&] { retarget(motion, convention); },
              ThrowsMessage<Error>("m: no joint is called \"pelvis\", which convention t expects"));
  EXPECT_THAT(
      [&] { find_convention(motion, builtin_conventions()); },
      ThrowsMessage<Error>(HasSubstr("fit none of the conventions known: asf_amc (no joint \"root\"), cmu_bvh")));
}

TEST(Convention, IncludesThoseOfTheProgram) {
  std::vector<std::string> names;
  for (const MotionConvention& convention : builtin_conventions()) names.push_back(convention.name);
  EXPECT_THAT(names, testing::ElementsAre("asf_amc", "cmu_bvh", "daz_bvh"));
  for (const MotionConvention& convention : builtin_conventions()) {
    for (int b = 1; b < kBoneCount; ++b) {
      const BoneSource& bone = convention.bones[b];
      const BoneSource& other = convention.bones[index(mirror(static_cast<Bone>(b)))];
      EXPECT_EQ(bone.rest, other.rest) << convention.name << ' ' << bone.from[0];
    }
  }
}

TEST(Convention, NamesLineAndReasonOfErrors) {
  EXPECT_THAT(parsing(toml("tail = { from = [\"x\"], rest = \"same\" }\n")),
              ThrowsMessage<Error>("c.toml:23: no bone is called \"tail\""));
  EXPECT_THAT(parsing("name = \"t\"\nskip_frames = 0\n[bones]\n"),
              ThrowsMessage<Error>("c.toml:3: missing bone \"pelvis\""));
  EXPECT_THAT(parsing("name = \"t\"\nskip_frames = -1\n[bones]\n"),
              ThrowsMessage<Error>(HasSubstr("c.toml:2: skip_frames")));
  EXPECT_THAT(parsing("name = [\n"), ThrowsMessage<Error>(HasSubstr("not valid TOML")));
  EXPECT_THAT(parsing(replaced(toml(), "rest = \"aim\"", "rest = \"l_shinn\"")),
              ThrowsMessage<Error>(HasSubstr("no bone is called \"l_shinn\"")));
  EXPECT_THAT(parsing(replaced(toml(), "rest = \"aim\"", "rest = \"l_thigh\"")),
              ThrowsMessage<Error>(HasSubstr("expected a bone with \"same\" or \"aim\"")));
  EXPECT_THAT(parsing(replaced(toml(), "from = [\"head\"]", "from = []")),
              ThrowsMessage<Error>(HasSubstr("from: expected an array of one or two joints")));
  EXPECT_THAT(parsing(std::string(20000, '#')), ThrowsMessage<Error>(HasSubstr("expected at most 16384 bytes")));
}

TEST(Retarget, KeepsHeadingsAndWaysOfMovements) {
  Motion motion = still_motion(4);
  for (const Bone bone : {Bone::l_shin, Bone::l_foot}) motion.joints[index(bone)].offset = {0.F, -2.F, 0.F};
  for (int f = 1; f < 4; ++f) {
    const Eigen::Quaternionf heading = turn(170.F * static_cast<float>(f), Eigen::Vector3f::UnitY());
    for (int b = 0; b < kBoneCount; ++b) motion.world[static_cast<std::size_t>(f * kBoneCount + b)] = heading;
    motion.root[static_cast<std::size_t>(f)] = {static_cast<float>(f), 3.F, 2.F};
  }
  const Movement movement = retarget_movement(motion, parse_convention(toml(), "c.toml"));
  ASSERT_EQ(movement.states.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const BodyState& state = movement.states[i];
    EXPECT_LT(state.pose[Bone::pelvis].angularDistance(Eigen::Quaternionf::Identity()), 1e-3F);
    EXPECT_TRUE(state.root.isApprox(Eigen::Vector2f(static_cast<float>(i + 1), 2.F) / 4.F)) << "in lengths of the leg";
    EXPECT_FLOAT_EQ(state.height, 0.75F);
    if (i > 0) {
      EXPECT_NEAR(state.heading_rad - movement.states[i - 1].heading_rad, 170.F * kPi / 180.F, 1e-3F);
    }
  }
  EXPECT_THAT([] { retarget_movement(still_motion(3), parse_convention(toml(), "c.toml")); },
              ThrowsMessage<Error>(HasSubstr("its legs have no length")));
}

}  // namespace
}  // namespace vesalius::synth
