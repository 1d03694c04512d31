#include "commands/synth/imitate_sensor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

#include "io/files/options_file.h"
#include "io/files/test_files.h"
#include "synth/generate.h"
#include "vesalius/error.h"
#include "vesalius/image_file.h"

namespace vesalius::cli {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

synth::Recipe small_rooms() {
  synth::Recipe recipe;
  recipe.body.kind = "builtin";
  recipe.body.count = 2;
  recipe.pose.captured = 0.F;
  return recipe;
}

/// Measures rendered frames whose sensor is known.
MeasuredCamera measure_rendered(const synth::SensorOptions& sensor, int frames) {
  synth::Recipe recipe = small_rooms();
  recipe.sensor = sensor;
  const synth::Generator generator(recipe, {}, paper_body(), 99);
  synth::DepthStatistics statistics;
  for (int i = 0; i < frames; ++i) statistics.add(generator.frame(i).frame.depth);
  return {.camera = synth::sensor_of(sensor).camera, .frames = frames, .figures = statistics.figures(), .notes = {}};
}

synth::SensorOptions small_sensor(const char* preset) {
  synth::SensorOptions sensor;
  sensor.preset = preset;
  sensor.width = 160;
  sensor.height = 90;
  sensor.colour = false;
  return sensor;
}

TEST(ImitateSensor, NothingIsUnlikeItself) {
  const synth::DepthFigures figures = measure_rendered(small_sensor("d435"), 6).figures;
  synth::DepthFigures noisy = figures, unmeasured = figures;
  noisy.noise_mm[1] *= 2.0;
  unmeasured.noise_mm[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(unlikeness(figures, figures), 0.0);
  EXPECT_GT(unlikeness(noisy, figures), 0.02);
  EXPECT_EQ(unlikeness(unmeasured, figures), 0.0);
}

TEST(ImitateSensor, FindsWhatDriversAndRecordersDidToDepth) {
  synth::SensorOptions sensor = small_sensor("d435");
  sensor.variety.resampled.share = 1.F;
  sensor.variety.resampled.smallest = 0.5F;
  sensor.variety.resampled.holes_blended = 1.F;
  const MeasuredCamera real = measure_rendered(sensor, 12);
  const Imitation found = imitate(real, "d435", small_rooms(), 8, 1, false);
  EXPECT_GT(found.sensor.variety.resampled.share, 0.F);
  EXPECT_GT(found.sensor.variety.resampled.holes_blended, 0.F);
  EXPECT_LT(unlikeness(found.figures, real.figures), 0.6 * unlikeness(found.preset, real.figures));

  const std::string toml = imitation_toml("recording", real, found);
  EXPECT_THAT(toml, HasSubstr("recording (12 frames)"));
  synth::Recipe read;
  parse_options(toml, "like.toml", [&](OptionVisitor& visitor) { visit_options("", read, visitor); });
  EXPECT_EQ(read.sensor.preset, "d435");
  EXPECT_EQ(read.sensor.width, 160);
  EXPECT_EQ(read.sensor.variety.resampled.share, found.sensor.variety.resampled.share);
}

TEST(ImitateSensor, SaysWhatItCannotMeasure) {
  const test::TemporaryFolder folder;
  EXPECT_THAT([&] { (void)measure_source(folder.path() + "/nothing", 10); },
              ThrowsMessage<Error>(HasSubstr("nothing")));
  (void)test::put(folder.path() + "/empty/meta.json", R"({"fx": 30, "fy": 30, "cx": 16, "cy": 12})");
  std::filesystem::create_directories(folder.path() + "/empty/depth");
  write_png(DepthImage(32, 24, 0), folder.path() + "/empty/depth/1.png");
  EXPECT_THAT([&] { (void)measure_source(folder.path() + "/empty", 10); },
              ThrowsMessage<Error>(HasSubstr("has a depth")));
  const MeasuredCamera real = measure_rendered(small_sensor("d435"), 2);
  EXPECT_THAT([&] { (void)imitate(real, "d436", small_rooms(), 2, 1, false); },
              ThrowsMessage<UsageError>(HasSubstr("d435")));
}

}  // namespace
}  // namespace vesalius::cli
