#include "io/files/plain_text.h"

#include <gtest/gtest.h>

namespace vesalius {
namespace {

TEST(PlainText, CountsInWords) {
  EXPECT_EQ(counted(0, "frame"), "0 frames");
  EXPECT_EQ(counted(1, "frame"), "1 frame");
  EXPECT_EQ(counted(2, "frame"), "2 frames");
  EXPECT_EQ(counted(1, "person", "people"), "1 person");
  EXPECT_EQ(counted(12, "person", "people"), "12 people");
}

}  // namespace
}  // namespace vesalius
