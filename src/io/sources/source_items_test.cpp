#include "io/sources/source_items.h"

#include <gmock/gmock.h>

namespace vesalius {
namespace {

TEST(SourceItems, AreLinesWhoseColumnsAlign) {
  const std::string text = to_text({{"/depth", "Image 16UC1 640x480", 120, "depth", ""},
                                    {"/camera/ir", "Image 8UC1", 7, "", "8 bits, expected 16"},
                                    {"rgb", "JPEG", -1, "colour", "4 ms later"}});
  EXPECT_EQ(text,
            "  /depth      Image 16UC1 640x480     120  depth\n"
            "  /camera/ir  Image 8UC1                7  not taken: 8 bits, expected 16\n"
            "  rgb         JPEG                         colour: 4 ms later\n");
  EXPECT_EQ(to_text({}), "");
}

TEST(SourceItems, StandBelowAMessage) {
  EXPECT_EQ(with_items("no depth", {{"a", "b", 1, "", ""}}), "no depth\n  a  b       1  not taken");
  EXPECT_EQ(with_items("no depth", {}), "no depth");
}

}  // namespace
}  // namespace vesalius
