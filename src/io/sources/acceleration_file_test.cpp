#include "io/sources/acceleration_file.h"

#include <gmock/gmock.h>

#include "io/files/test_files.h"
#include "vesalius/image_file.h"
#include "vesalius/open_source.h"

namespace vesalius {
namespace {

using test::error_of;
using test::put;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(AccelerationFile, ReadsWhatItWrites) {
  const std::vector<TimedAcceleration> measured{{0.25, {0.5, -9.75, 1.0}}, {1305031102.160407, {0.0, -9.8066, 0.0}}};
  const std::string text = serialise_accelerations(measured);
  EXPECT_THAT(text, testing::StartsWith("time_s,x,y,z\n0.25,0.5000,-9.7500,1.0000\n1305031102.160407,"));
  const auto read = parse_accelerations(text, "imu.csv");
  ASSERT_EQ(read.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(read[i].time_s, measured[i].time_s);
    EXPECT_EQ(read[i].m_s2, measured[i].m_s2);
  }
}

TEST(AccelerationFile, SortsAndSkips) {
  const auto read = parse_accelerations("# a camera\n\n2 0 -9.8 0\r\n1\t1 -9 0\n", "imu.csv");
  ASSERT_EQ(read.size(), 2U);
  EXPECT_EQ(read[0].time_s, 1.0);
  EXPECT_EQ(read[1].m_s2.y(), -9.8);
  EXPECT_THAT(parse_accelerations("", "imu.csv"), IsEmpty());
}

TEST(AccelerationFile, NamesTheLineThatIsNone) {
  for (const char* line : {"1,2,3", "1,2,3,4,5", "1,2,3,x", "1,2,3,nan", "time_s,x,y,z"}) {
    const std::string text = std::string("time_s,x,y,z\n0,0,-9.8,0\n") + line + "\n";
    EXPECT_EQ(error_of([&] { parse_accelerations(text, "imu.csv"); }),
              "imu.csv:3: expected \"time_s,x,y,z\", four numbers")
        << line;
  }
}

TEST(AccelerationFile, NamesMayComeFirstAndNothingElse) {
  EXPECT_THAT(parse_accelerations("timestamp ax ay az\n", "imu.csv"), IsEmpty());
  for (const std::string first : {"time_s,x,y", "0.1,x,y,z", "1,2,nan,3", "\x01\x02\x03"}) {
    EXPECT_THAT(error_of([&] { parse_accelerations(first + "\n0,0,-9.8,0\n", "imu.csv"); }), HasSubstr("imu.csv:1: "))
        << first;
  }
}

TEST(AccelerationFile, TellsFramesWhereUpIs) {
  const TemporaryFolder folder;
  put(folder / "meta.json", R"({"width": 64, "height": 48, "fx": 50, "fy": 50, "cx": 31, "cy": 23, "rate_hz": 1})");
  for (const char* name : {"0", "1", "2", "3"})
    put(folder / ("depth/" + std::string(name) + ".png"), encode_png(DepthImage(64, 48, 1000)));
  // Measured twice before frame 1, and on the way down before frame 3.
  put(folder / "imu.csv", "time_s,x,y,z\n0.7,0,-9.8,0.2\n0.9,0,-9.8,-0.2\n2.8,0,-1,0\n");
  const auto source = open_source(folder.path());
  EXPECT_THAT(source->notes(), IsEmpty());
  EXPECT_THAT(source->contents(), testing::Contains(testing::AllOf(testing::Field(&SourceItem::name, "imu.csv"),
                                                                   testing::Field(&SourceItem::use, "up"))));
  EXPECT_FALSE(source->next()->up);
  EXPECT_TRUE(source->next()->up->isApprox(-Eigen::Vector3f::UnitY(), 1e-6F));
  EXPECT_FALSE(source->next()->up);
  EXPECT_FALSE(source->next()->up);
  EXPECT_TRUE(open_source(folder / "depth")->next());
  source->seek(1.0);
  EXPECT_TRUE(source->next()->up) << "in any order";
}

TEST(AccelerationFile, SaysWhereFramesHaveNoTimes) {
  const TemporaryFolder folder;
  put(folder / "meta.json", R"({"width": 64, "height": 48, "fx": 50, "fy": 50, "cx": 31, "cy": 23})");
  put(folder / "depth/0.png", encode_png(DepthImage(64, 48, 1000)));
  put(folder / "imu.csv", "0,0,-9.8,0\n");
  const auto source = open_source(folder.path());
  EXPECT_THAT(source->notes(), ElementsAre(HasSubstr("imu.csv: not used: frames have no times, expected")));
  EXPECT_FALSE(source->next()->up);
}

}  // namespace
}  // namespace vesalius
