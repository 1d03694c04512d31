#include <gmock/gmock.h>

#include "synth/mocap/motion.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double kDegree = 3.14159265358979 / 180.0;

const std::string kAsf =
    "# made by hand\r\n"
    ":version 1.10\r\n"
    ":name TEST\r\n"
    ":units\r\n"
    "  mass 1.0\r\n"
    "  angle deg\r\n"
    ":documentation\r\n"
    "  begin nothing: of interest\r\n"
    ":root\r\n"
    "  order TX TY TZ RX RY RZ\r\n"
    "  axis XYZ\r\n"
    "  position 0 0 0\r\n"
    "  orientation 0 0 0\r\n"
    ":bonedata\r\n"
    "  begin\r\n"
    "    id 1\r\n"
    "    name shin\r\n"
    "    direction 0 -2 0\r\n"
    "    length 7\r\n"
    "    axis 0 0 20 XYZ\r\n"
    "    dof rx\r\n"
    "    limits (-10.0 170.0)\r\n"
    "  end\r\n"
    "  begin\r\n"
    "    id 2\r\n"
    "    name thigh\r\n"
    "    direction 1 0 0\r\n"
    "    length 3\r\n"
    "    axis 10 20 30 XYZ\r\n"
    "    dof rx ry rz\r\n"
    "    limits (-160.0 20.0)\r\n"
    "           (-70.0 70.0)\r\n"
    "           (-60.0 70.0)\r\n"
    "  end\r\n"
    ":hierarchy\r\n"
    "  begin\r\n"
    "    root thigh\r\n"
    "    thigh shin\r\n"
    "  end\r\n";

const std::string kAmc = ":FULLY-SPECIFIED\n:DEGREES\n1\nroot 1 2 3 10 20 30\nthigh 40 50 60\nshin 70\n2\nshin 90\n";

Eigen::Quaterniond turn(const Eigen::Vector3d& axis, double degrees) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * kDegree, axis));
}
/// Returns Rz Ry Rx.
Eigen::Quaterniond xyz(double x, double y, double z) {
  return turn(Eigen::Vector3d::UnitZ(), z) * turn(Eigen::Vector3d::UnitY(), y) * turn(Eigen::Vector3d::UnitX(), x);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}
auto parsing_asf(const std::string& text) {
  return [text] { parse_asf(text, "s.asf"); };
}
auto parsing_amc(const std::string& text) {
  return [text] { parse_amc(text, "m.amc", parse_asf(kAsf, "s.asf"), 120.F); };
}
void expect_same(const Eigen::Quaternionf& a, const Eigen::Quaterniond& b) {
  EXPECT_LT(a.angularDistance(b.cast<float>()), 1e-3F);
}

TEST(Asf, ReadsBonesParentsFirst) {
  const AsfSkeleton skeleton = parse_asf(kAsf, "s.asf");
  ASSERT_EQ(skeleton.bones.size(), 3U);
  EXPECT_EQ(skeleton.bones[0].name, "root");
  EXPECT_THAT(skeleton.bones[0].dofs, ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_EQ(skeleton.bones[1].name, "thigh");
  EXPECT_EQ(skeleton.bones[2].name, "shin");
  EXPECT_EQ(skeleton.bones[2].parent, 1);
  EXPECT_TRUE(skeleton.bones[2].direction.isApprox(-Eigen::Vector3f::UnitY())) << "made a unit vector";
  EXPECT_EQ(skeleton.bones[2].length, 7.F);
  expect_same(skeleton.bones[1].axis.cast<float>(), xyz(10, 20, 30));
  EXPECT_TRUE(skeleton.degrees);
}

TEST(Asf, NamesLineAndReasonOfErrors) {
  EXPECT_THAT(parsing_asf(replaced(kAsf, "dof rx\r", "dof rx rw\r")),
              ThrowsMessage<Error>("s.asf:21: expected tx, ty, tz, rx, ry, rz or l, found \"rw\""));
  EXPECT_THAT(parsing_asf(replaced(kAsf, "20 XYZ", "20 XXZ")),
              ThrowsMessage<Error>("s.asf:20: expected an order of axes such as XYZ, found \"XXZ\""));
  EXPECT_THAT(parsing_asf(replaced(kAsf, "0 -2 0", "0 0 0")), ThrowsMessage<Error>(HasSubstr("s.asf:18: direction")));
  EXPECT_THAT(parsing_asf(replaced(kAsf, "0 -2 0", "0 nan 0")), ThrowsMessage<Error>(HasSubstr("s.asf:18: expected")));
  EXPECT_THAT(parsing_asf(replaced(kAsf, "thigh shin", "thigh foot")),
              ThrowsMessage<Error>("s.asf:38: no bone is called \"foot\""));
  EXPECT_THAT(parsing_asf(replaced(kAsf, "root thigh", "root thigh shin")),
              ThrowsMessage<Error>("s.asf:38: bone \"shin\" hangs from two others"));
  EXPECT_THAT(parsing_asf(replaced(kAsf, "    thigh shin\r\n", "")),
              ThrowsMessage<Error>(HasSubstr("bone \"shin\" does not hang from the root")));
  EXPECT_THAT(parsing_asf(replaced(kAsf, "root thigh", "shin thigh")),
              ThrowsMessage<Error>(HasSubstr("does not hang from the root")))
      << "a ring";
  EXPECT_THAT(parsing_asf(replaced(kAsf, "angle deg", "angle grad")),
              ThrowsMessage<Error>(HasSubstr("s.asf:6: angle")));
  EXPECT_THAT(parsing_asf(replaced(kAsf, "name thigh", "name shin")),
              ThrowsMessage<Error>(HasSubstr("a second bone called \"shin\"")));
  EXPECT_THAT(parsing_asf("HIERARCHY"), ThrowsMessage<Error>(HasSubstr("s.asf:1: expected a section")));
  for (std::size_t n = 0; n < kAsf.size() - 6; ++n) EXPECT_THROW(parse_asf(kAsf.substr(0, n), "cut"), Error) << n;
}

TEST(Amc, TurnsBonesAboutTheirAxes) {
  const Motion motion = parse_amc(kAmc, "m.amc", parse_asf(kAsf, "s.asf"), 120.F);
  ASSERT_EQ(motion.frame_count(), 2);
  EXPECT_EQ(motion.fps, 120.F);
  EXPECT_EQ(motion.root[0], Eigen::Vector3f(1, 2, 3));
  EXPECT_TRUE(motion.joints[2].offset.isApprox(Eigen::Vector3f(3, 0, 0))) << "starts where the thigh ends";
  const Eigen::Quaterniond c = xyz(10, 20, 30), d = xyz(0, 0, 20);
  const Eigen::Quaterniond root = xyz(10, 20, 30), thigh = root * c * xyz(40, 50, 60) * c.conjugate();
  expect_same(motion.rotation(0, 0), root);
  expect_same(motion.rotation(0, 1), thigh);
  expect_same(motion.rotation(0, 2), thigh * d * xyz(70, 0, 0) * d.conjugate());
}

TEST(Amc, TakesMissingValuesAsZero) {
  const Motion motion = parse_amc(kAmc, "m.amc", parse_asf(kAsf, "s.asf"), 120.F);
  const Eigen::Quaterniond d = xyz(0, 0, 20);
  expect_same(motion.rotation(1, 1), Eigen::Quaterniond::Identity());
  expect_same(motion.rotation(1, 2), d * xyz(90, 0, 0) * d.conjugate());
  EXPECT_EQ(motion.root[1], Eigen::Vector3f(0, 0, 0));
}

TEST(Amc, TakesRadians) {
  const AsfSkeleton skeleton = parse_asf(kAsf, "s.asf");
  const Motion motion = parse_amc(":RADIANS\n1\nroot 0 0 0 0 1.5707963 0\n", "m.amc", skeleton, 120.F);
  expect_same(motion.rotation(0, 0), xyz(0, 90, 0));
}

TEST(Amc, NamesLineAndReasonOfErrors) {
  EXPECT_THAT(parsing_amc(replaced(kAmc, "shin 70", "toe 70")),
              ThrowsMessage<Error>("m.amc:6: bone \"toe\" is not in the skeleton s.asf"));
  EXPECT_THAT(parsing_amc(replaced(kAmc, "40 50 60", "40 50")),
              ThrowsMessage<Error>("m.amc:5: bone \"thigh\": expected 3 numbers, found 2"));
  EXPECT_THAT(parsing_amc(replaced(kAmc, "40 50 60", "40 50 60 70")),
              ThrowsMessage<Error>("m.amc:5: bone \"thigh\": expected 3 numbers, found more"));
  EXPECT_THAT(parsing_amc(replaced(kAmc, "40 50 60", "40 nan 60")),
              ThrowsMessage<Error>(HasSubstr("m.amc:5: expected")));
  EXPECT_THAT(parsing_amc(replaced(kAmc, "shin 70", "thigh 1 2 3")),
              ThrowsMessage<Error>("m.amc:6: bone \"thigh\" stands twice in a frame"));
  EXPECT_THAT(parsing_amc(replaced(kAmc, "1\nroot", "1 root")), ThrowsMessage<Error>(HasSubstr("m.amc:3: ")));
  EXPECT_THAT(parsing_amc(":DEGREES\n"), ThrowsMessage<Error>(HasSubstr("expected at least one frame")));
  EXPECT_THAT(parsing_amc("walk"), ThrowsMessage<Error>(HasSubstr("m.amc:1: expected the number of a frame")));
  EXPECT_THAT([] { parse_amc(kAmc, "m.amc", parse_asf(kAsf, "s.asf"), 0.F); },
              ThrowsMessage<Error>(HasSubstr("m.amc")));
}

}  // namespace
}  // namespace vesalius::synth
