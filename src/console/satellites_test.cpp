#include "console/satellites.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vesalius::cli {
namespace {

// After `./dev demo` the program has neither training nor viewer.
TEST(AbsentCommand, SaysHowItIsHad) {
  for (const char* command : {"evaluate", "train", "view", "ros2"}) {
    EXPECT_THAT(absent_command(command),
                testing::AllOf(testing::StartsWith(std::string(command) + " is not in this build"),
                               testing::HasSubstr("./dev build")));
  }
  EXPECT_EQ(absent_command("detekt"), "");
}

}  // namespace
}  // namespace vesalius::cli
