#include <gmock/gmock.h>

#include "synth/mocap/motion.h"
#include "synth/text/test_text.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr float kPi = 3.14159265F;

const std::string kFile =
    "HIERARCHY\n"
    "ROOT Hips\n"
    "{\n"
    "\tOFFSET 0 1 0\n"
    "\tCHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation\n"
    "\tJOINT LHip\n"
    "\t{\n"
    "\t\tOFFSET 0 0 0\n"
    "\t\tCHANNELS 0\n"
    "\t\tJOINT Leg\n"
    "\t\t{\n"
    "\t\t\tOFFSET 2 0 0\n"
    "\t\t\tCHANNELS 3 Yrotation Xrotation Zrotation\n"
    "\t\t\tEnd Site\n"
    "\t\t\t{\n"
    "\t\t\t\tOFFSET 0 -3 0\n"
    "\t\t\t}\n"
    "\t\t}\n"
    "\t}\n"
    "}\n"
    "MOTION\n"
    "Frames: 2\n"
    "Frame Time: 0.04\n"
    "1 2 3 0 0 0 0 0 0\n"
    "4 5 6 90 0 90 30 40 50\n";

Eigen::Matrix3f turn(char axis, float degrees) {
  const Eigen::Vector3f a = axis == 'x'   ? Eigen::Vector3f::UnitX()
                            : axis == 'y' ? Eigen::Vector3f::UnitY()
                                          : Eigen::Vector3f::UnitZ();
  return Eigen::AngleAxisf(degrees * kPi / 180.F, a).toRotationMatrix();
}

std::string replaced(const std::string& from, const std::string& to) {
  std::string text = kFile;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

auto parsing(const std::string& text) {
  return [text] { parse_bvh(text, "m.bvh"); };
}

TEST(Bvh, ReadsJointsAndTheirDirections) {
  const Motion motion = parse_bvh(kFile, "m.bvh");
  ASSERT_EQ(motion.joint_count(), 3);
  EXPECT_EQ(motion.joints[0].name, "Hips");
  EXPECT_EQ(motion.joints[0].parent, -1);
  EXPECT_EQ(motion.joints[2].parent, 1);
  EXPECT_EQ(motion.find_joint("Leg"), 2);
  EXPECT_EQ(motion.find_joint("Arm"), -1);
  EXPECT_TRUE(motion.joints[0].along.isZero()) << "its child lies in the same place";
  EXPECT_TRUE(motion.joints[1].along.isApprox(Eigen::Vector3f::UnitX()));
  EXPECT_TRUE(motion.joints[2].along.isApprox(-Eigen::Vector3f::UnitY())) << "from the end site";
  EXPECT_FLOAT_EQ(motion.fps, 25.F);
}

TEST(Bvh, AppliesChannelsInTheirOrder) {
  const Motion motion = parse_bvh(kFile, "m.bvh");
  ASSERT_EQ(motion.frame_count(), 2);
  EXPECT_EQ(motion.root[1], Eigen::Vector3f(4, 5, 6));
  EXPECT_TRUE(motion.rotation(0, 2).isApprox(Eigen::Quaternionf::Identity()));
  const Eigen::Matrix3f hips = turn('z', 90.F) * turn('x', 90.F);
  const Eigen::Matrix3f leg = hips * turn('y', 30.F) * turn('x', 40.F) * turn('z', 50.F);
  EXPECT_TRUE(motion.rotation(1, 0).toRotationMatrix().isApprox(hips, 1e-5F));
  EXPECT_TRUE(motion.rotation(1, 1).toRotationMatrix().isApprox(hips, 1e-5F));
  EXPECT_TRUE(motion.rotation(1, 2).toRotationMatrix().isApprox(leg, 1e-5F));
}

TEST(Bvh, AcceptsOtherLineEndsAndMovingJoints) {
  const std::string crlf = synth::replaced(kFile, "\n", "\r\n");
  EXPECT_EQ(parse_bvh(crlf, "m.bvh").frame_count(), 2);
  std::string moving = replaced("CHANNELS 0", "CHANNELS 3 Zposition Xposition Yposition");
  moving.resize(moving.find("1 2 3"));
  const Motion moved = parse_bvh(moving + "1 2 3 0 0 0 7 8 9 0 0 0\n4 5 6 90 0 0 7 8 9 0 0 0\n", "m.bvh");
  EXPECT_TRUE(moved.rotation(1, 2).toRotationMatrix().isApprox(turn('z', 90.F), 1e-5F));
  EXPECT_EQ(moved.frame_count(), 2);
}

TEST(Bvh, RefusesWrongChannels) {
  EXPECT_THAT(parsing(replaced("CHANNELS 3 Yrotation Xrotation", "CHANNELS 3 Yrotation")),
              ThrowsMessage<Error>("m.bvh:14: channel 3 of 3: expected Xposition ... Zrotation, found \"End\""));
  EXPECT_THAT(parsing(replaced("CHANNELS 3", "CHANNELS 2")),
              ThrowsMessage<Error>("m.bvh:13: expected 2 names of channels, found more"));
  EXPECT_THAT(parsing(replaced("CHANNELS 3", "CHANNELS 7")), ThrowsMessage<Error>(HasSubstr("m.bvh:13: expected the")));
  EXPECT_THAT(parsing(replaced("3 Yrotation Xrotation", "3 Xrotation Xrotation")),
              ThrowsMessage<Error>("m.bvh:13: channel Xrotation stands twice"));
}

TEST(Bvh, RefusesWrongNumbersOfValues) {
  EXPECT_THAT(parsing(replaced("1 2 3 0 0 0 0 0 0\n", "1 2 3 0 0 0 0 0\n")),
              ThrowsMessage<Error>("m.bvh:24: frame 1: expected 9 numbers, found 8"));
  EXPECT_THAT(parsing(replaced("1 2 3 0 0 0 0 0 0\n", "1 2 3 0 0 0 0 0 0 0\n")),
              ThrowsMessage<Error>("m.bvh:24: frame 1: expected 9 numbers, found more"));
  EXPECT_THAT(parsing(replaced("Frames: 2", "Frames: 3")),
              ThrowsMessage<Error>(HasSubstr("found the end of the file")));
  EXPECT_THAT(parsing(replaced("Frames: 2", "Frames: 1")),
              ThrowsMessage<Error>("m.bvh:25: expected the end after 1 frames"));
  EXPECT_THAT(parsing(replaced("4 5 6", "4 nan 6")), ThrowsMessage<Error>(HasSubstr("m.bvh:25: expected a number")));
}

TEST(Bvh, RefusesSizesThatTheFileCannotHold) {
  EXPECT_THAT(parsing(replaced("Frames: 2", "Frames: 99999999")),
              ThrowsMessage<Error>("m.bvh:22: 99999999 frames of 9 numbers: the file is too short for them"));
  EXPECT_THAT(parsing(replaced("Frames: 2", "Frames: 0")),
              ThrowsMessage<Error>(HasSubstr("m.bvh:22: expected the number")));
  EXPECT_THAT(parsing(replaced("0.04", "0")), ThrowsMessage<Error>(HasSubstr("m.bvh:23: the time of a frame")));
  std::string deep = "HIERARCHY\nROOT r {\nOFFSET 0 0 0\nCHANNELS 0\n";
  for (int i = 0; i < 2000; ++i) deep += "JOINT j" + std::to_string(i) + " {\nOFFSET 0 0 0\nCHANNELS 0\n";
  EXPECT_THAT(parsing(deep), ThrowsMessage<Error>("m.bvh:3002: more than 1000 joints"));
}

TEST(Bvh, RefusesOtherTexts) {
  EXPECT_THAT(parsing(""), ThrowsMessage<Error>("m.bvh:1: expected HIERARCHY, found the end of the file"));
  EXPECT_THAT(parsing(replaced("JOINT Leg", "JOINT LHip")), ThrowsMessage<Error>(HasSubstr("a second joint called")));
  EXPECT_THAT(parsing(replaced("End Site", "Ende")), ThrowsMessage<Error>(HasSubstr("expected JOINT, End or }")));
  for (std::size_t n = 0; n < kFile.size() - 2; ++n) EXPECT_THROW(parse_bvh(kFile.substr(0, n), "cut"), Error) << n;
}

}  // namespace
}  // namespace vesalius::synth
