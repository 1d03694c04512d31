#include "console/option_flags.h"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

#include "vesalius/detect.h"

namespace vesalius::cli {
namespace {

TEST(OptionFlags, OverwriteOnlyOptionsOfTheCommandLine) {
  CLI::App app;
  const OptionFlags<DetectOptions> flags(app);
  app.parse("--search.min-parts 9 --no-refine.second-pass");
  DetectOptions options;
  options.search.max_mean_error = 0.25F;  // as if read from a file
  options.search.min_parts = 5;
  flags.apply(options);
  EXPECT_EQ(options.search.min_parts, 9);
  EXPECT_FALSE(options.refine.second_pass);
  EXPECT_EQ(options.search.max_mean_error, 0.25F);
  EXPECT_EQ(options.cluster.max_gap_m, DetectOptions{}.cluster.max_gap_m);
}

TEST(OptionFlags, SwitchesCanBeTurnedOnAgain) {
  CLI::App app;
  const OptionFlags<DetectOptions> flags(app);
  app.parse("--refine.second-pass");
  DetectOptions options;
  options.refine.second_pass = false;
  flags.apply(options);
  EXPECT_TRUE(options.refine.second_pass);
}

TEST(OptionFlags, RefuseInvalidValues) {
  CLI::App app;
  const OptionFlags<DetectOptions> flags(app);
  EXPECT_THROW(app.parse("--search.min-parts many"), CLI::ParseError);
  EXPECT_THROW(app.parse("--search.min-part 3"), CLI::ParseError);
}

}  // namespace
}  // namespace vesalius::cli
