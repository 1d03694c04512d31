#include "io/recordings/oni_depth.h"

#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "io/files/test_files.h"

namespace vesalius {
namespace {

using test::error_of;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::string bytes(const std::vector<int>& values) {
  std::string text;
  for (const int value : values) text += static_cast<char>(value);
  return text;
}

std::vector<int> unpacked(const std::vector<int>& packed, OniPacking packing, int width, int height) {
  const Image<std::uint16_t> image = unpack_oni(bytes(packed), packing, width, height, "a");
  return {image.begin(), image.end()};
}

TEST(OniDepth, StepsOfHalfAByteGoDownBySixLess) {
  // 1000; codes 6 + 1, 6 - 2: 999, 1001; codes 0, 12: 1007, 1001; code 6 and none to fill the byte: 1001.
  EXPECT_THAT(unpacked({0xE8, 0x03, 0x74, 0x0C, 0x6D}, OniPacking::differences, 3, 2),
              ElementsAre(1000, 999, 1001, 1007, 1001, 1001));
}

TEST(OniDepth, RunsAreTwoPixelsForEachInTheirCount) {
  EXPECT_THAT(unpacked({0x05, 0x00, 0xE3, 0xE1}, OniPacking::differences, 9, 1),
              ElementsAre(5, 5, 5, 5, 5, 5, 5, 5, 5));
  EXPECT_THAT(unpacked({0x05, 0x00, 0xE0}, OniPacking::differences, 1, 1), ElementsAre(5));
}

TEST(OniDepth, EscapesHoldLongStepsAndNewValues) {
  // 500; a whole escape with step 192 + 63: 437; one with step 192 - 63: 500; a whole one with a value: 0x0BB8.
  EXPECT_THAT(unpacked({0xF4, 0x01, 0xFF, 0xFF, 0xFF, 0x81, 0xFF, 0x0B, 0xB8}, OniPacking::differences, 4, 1),
              ElementsAre(500, 437, 500, 3000));
  // After one step in the first half: 499, then 0, then 499 - 499 again by a step of 10.
  EXPECT_THAT(unpacked({0xF4, 0x01, 0x7F, 0x00, 0x00, 0x5F, 0xC0 - 10}, OniPacking::differences, 5, 1),
              ElementsAre(500, 499, 0, 1, 11));
}

TEST(OniDepth, ATableTurnsNumbersIntoValues) {
  // Three values: 0, 1200, 4000. Numbers 2, then codes 6 + 2, 6 - 1: 0, 1; a run of two.
  EXPECT_THAT(unpacked({3, 0, 0, 0, 0xB0, 0x04, 0xA0, 0x0F, 2, 0, 0x85, 0xE1}, OniPacking::table_differences, 5, 1),
              ElementsAre(4000, 0, 1200, 1200, 1200));
}

TEST(OniDepth, RefusesWhatIsDamaged) {
  const auto error = [](const std::vector<int>& packed, OniPacking packing, int width) {
    return error_of([&] { unpacked(packed, packing, width, 1); });
  };
  EXPECT_THAT(error({5, 0, 0xE1}, OniPacking::differences, 2),
              AllOf(HasSubstr("a: "), HasSubstr("more than 2 pixels")));
  EXPECT_THAT(error({5, 0, 0xE1}, OniPacking::differences, 4), HasSubstr("3 pixels of depth, expected 4"));
  EXPECT_THAT(error({5, 0, 0xFF}, OniPacking::differences, 2), HasSubstr("behind an escape"));
  EXPECT_THAT(error({5}, OniPacking::differences, 1), HasSubstr("first depth"));
  EXPECT_THAT(error({}, OniPacking::differences, 1), HasSubstr("too few"));
  EXPECT_THAT(error({5, 0}, OniPacking::differences, 10000), HasSubstr("too few for 10000x1 pixels"));
  EXPECT_THAT(error({1, 0, 7, 0, 1, 0}, OniPacking::table_differences, 1), HasSubstr("depth number 1 of a table of 1"));
  EXPECT_THAT(error({9, 0, 7, 0}, OniPacking::table_differences, 1), HasSubstr("table of depth"));
}

}  // namespace
}  // namespace vesalius
