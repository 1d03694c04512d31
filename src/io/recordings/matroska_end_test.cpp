#include "io/recordings/matroska_end.h"

#include <gmock/gmock.h>

#include <string>

namespace vesalius {
namespace {

const std::string kHead =
    "\x1A\x45\xDF\xA3\x83"
    "abc";
const std::string kSegment = "\x18\x53\x80\x67";

TEST(MatroskaEnd, IsBehindTheSegment) {
  EXPECT_EQ(stated_matroska_end(kHead + kSegment +
                                "\x85"
                                "12345"),
            8U + 5U + 5U);
  EXPECT_EQ(stated_matroska_end(kHead + kSegment +
                                "\x40\x81"
                                "1"),
            8U + 6U + 129U)
      << "wherever the file ends";
}

TEST(MatroskaEnd, IsNotKnownOfAFileThatWasNotCompleted) {
  EXPECT_FALSE(stated_matroska_end(kHead + kSegment +
                                   "\xFF"
                                   "12345"));
  EXPECT_FALSE(stated_matroska_end(kHead + kSegment + "\x01" + std::string(7, '\xFF')));
  EXPECT_FALSE(stated_matroska_end(kHead + kSegment + "\x01"));
  EXPECT_FALSE(stated_matroska_end(kHead));
  EXPECT_FALSE(stated_matroska_end(""));
  EXPECT_FALSE(stated_matroska_end(std::string(9, '\0')));
}

}  // namespace
}  // namespace vesalius
