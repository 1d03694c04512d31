#include "synth/body/rig_map.h"

#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

std::string map_text() {
  std::ifstream file(std::string(VESALIUS_SOURCE_DIR) + "/data/rigs/makehuman_default.toml");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

void expect_error(const std::string& from, const std::string& to, const std::string& message) {
  std::string text = map_text();
  const std::size_t at = text.find(from);
  ASSERT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  EXPECT_THAT([&] { parse_rig_map(text, "map.toml"); }, ThrowsMessage<Error>(HasSubstr(message))) << to;
}

const RigMap::Follow& follow_of(const std::string& rig) {
  const RigMap& map = makehuman_rig_map();
  return *std::ranges::find(map.follows, rig, &RigMap::Follow::rig);
}

TEST(RigMap, FillsStarsForBothSides) {
  const RigMap& map = makehuman_rig_map();
  EXPECT_EQ(map.bones[index(Bone::l_forearm)].joint, "lowerarm01.L");
  EXPECT_EQ(map.bones[index(Bone::r_forearm)].joint, "lowerarm01.R");
  EXPECT_EQ(map.bones[index(Bone::r_hand)].tail, "finger3-3.R");
  EXPECT_EQ(follow_of("lowerarm02.R").from, Bone::r_forearm);
  EXPECT_EQ(follow_of("lowerarm02.R").to, Bone::r_hand);
  EXPECT_TRUE(follow_of("lowerarm02.R").twist);
  EXPECT_EQ(follow_of("spine02").blend, 0.6F);
  EXPECT_EQ(map.fingers.size(), 30U);
  EXPECT_EQ(map.last_knuckle[1], "finger5-1.R");
}

TEST(RigMap, NamesTheReasonOfErrors) {
  expect_error("joint = \"pelvis.L\"", "joint = 3", "map.toml:12: joint: expected a string");
  expect_error("bone = \"spine\"", "bone = \"spin\"", "no bone of poses is called \"spin\"");
  expect_error("bone = \"spine\"", "bone = \"pelvis\"", "bone: listed twice");
  expect_error("rest = \"keep\"", "rest = \"kept\"", "rest \"kept\": expected keep, straighten or follow");
  expect_error("blend = 0.5", "blend = 1.5", "blend: expected a number from 0 to 1");
  expect_error("blend = 0.5", "blend = nan", "blend: expected a number from 0 to 1");
  expect_error("twist = true", "twist = 1", "twist: expected true or false");
  expect_error("twist = true", "twists = true", "unknown key \"twists\"");
  expect_error("[knuckles]", "[knuckle]", "unknown key \"knuckle\"");
  expect_error("tail = \"head\"\n", "", "[[bone]] head: expected a tail");
  expect_error("joint = \"spine04\"", "joint = \"spine04\"\ntail = \"x\"", "[[bone]] spine: expected no tail");
  expect_error("rig = \"finger1-1.*\"", "rig = \"finger1-1.L\"", "expected a name that ends in \".*\"");
  expect_error("[[bone]]", "[[bone]", "map.toml:10: not valid TOML");
  EXPECT_THROW(parse_rig_map("", "x"), Error);
  EXPECT_THROW(parse_rig_map(std::string(100000, '.'), "x"), Error);
}

/// Returns a skeleton of the bones that the map names, in a line.
std::vector<SkeletonBone> named_bones() {
  std::vector<SkeletonBone> bones;
  const RigMap& map = makehuman_rig_map();
  const auto add = [&](const std::string& name) {
    if (name.empty() || std::ranges::find(bones, name, &SkeletonBone::name) != bones.end()) return;
    bones.push_back({name, static_cast<int>(bones.size()) - 1, {0}, {0}});
  };
  add("root");
  for (const RigMap::Follow& f : map.follows) add(f.rig);
  for (const RigMap::Joint& j : map.bones) add(j.joint), add(j.tail);
  for (const RigMap::Finger& f : map.fingers) add(f.rig);
  return bones;
}

TEST(MapRig, LetsUnlistedBonesFollowTheirParents) {
  std::vector<SkeletonBone> bones = named_bones();
  const auto wrist = std::ranges::find(bones, "wrist.L", &SkeletonBone::name);
  bones.push_back({"nail", static_cast<int>(wrist - bones.begin()), {0}, {0}});
  const MappedRig rig = map_rig(bones, makehuman_rig_map());
  EXPECT_EQ(rig.bones.back().from, Bone::l_hand);
  EXPECT_EQ(rig.bones.back().grip, Grip::none);
}

TEST(MapRig, NamesAMissingBone) {
  std::vector<SkeletonBone> bones = named_bones();
  std::ranges::find(bones, "lowerleg01.R", &SkeletonBone::name)->name = "other";
  EXPECT_THAT([&] { map_rig(bones, makehuman_rig_map()); },
              ThrowsMessage<Error>(HasSubstr("the skeleton has no bone \"lowerleg01.R\"")));
  RigMap map = makehuman_rig_map();
  std::erase_if(map.follows, [](const RigMap::Follow& f) { return f.rig == "root"; });
  EXPECT_THAT([&] { map_rig(named_bones(), map); }, ThrowsMessage<Error>(HasSubstr("no [[follow]] for the root")));
}

}  // namespace
}  // namespace vesalius::synth
