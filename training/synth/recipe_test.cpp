#include "synth/recipe.h"

#include <gtest/gtest.h>

#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

TEST(Recipe, HasValidDefaults) { EXPECT_NO_THROW(check(Recipe{})); }

TEST(Recipe, PrefersIntrinsicsToThePreset) {
  SensorOptions options;
  options.preset = "kinect-v1";
  const Camera native = sensor_of(options).camera;
  options.width = native.width / 2;
  options.height = native.height / 2;
  EXPECT_NEAR(sensor_of(options).camera.fx, native.fx / 2.F, 1e-3F);
  options.fx = 300.F;
  options.cx = 10.F;
  const Camera own = sensor_of(options).camera;
  EXPECT_EQ(own.fx, 300.F);
  EXPECT_EQ(own.fy, 300.F);
  EXPECT_EQ(own.cx, 10.F);
  EXPECT_EQ(own.width, native.width / 2);
  EXPECT_FLOAT_EQ(sensor_of(options).lateral_px, find_sensor("kinect-v1").lateral_px * 300.F / native.fx)
      << "noise in pixels follows the focal length";
}

TEST(Recipe, AllowsOwnIntrinsicsTallerThanThePreset) {
  SensorOptions options;
  options.width = 480;
  options.height = 640;
  EXPECT_THROW(sensor_of(options), UsageError);
  options.fx = 525.F;
  const Camera own = sensor_of(options).camera;
  EXPECT_EQ(own.width, 480);
  EXPECT_EQ(own.height, 640);
  EXPECT_EQ(own.fx, 525.F);
  EXPECT_EQ(own.fy, 525.F);
  EXPECT_NEAR(own.cy, 319.5F, 20.F) << "about the middle row, as the preset's";
  options.cy = 300.F;
  EXPECT_EQ(sensor_of(options).camera.cy, 300.F);
  options.height = 100000;
  EXPECT_THROW(sensor_of(options), UsageError);
}

TEST(Recipe, ChecksWhoseBodiesItAsksFor) {
  Recipe recipe;
  recipe.body.people.age_min_years = 30.F;
  recipe.body.people.age_max_years = 10.F;
  EXPECT_THROW(check(recipe), UsageError);
  recipe = {};
  recipe.body.people.stature_min_m = 3.F;
  EXPECT_THROW(check(recipe), UsageError);
}

TEST(Recipe, HasAPerfectSensorWithoutNoise) {
  SensorOptions options;
  options.noise = false;
  EXPECT_EQ(sensor_of(options).kind, SensorKind::perfect);
}

TEST(Recipe, SplitsListsOfWordsAtCommas) {
  PoseOptions options;
  EXPECT_EQ(motion_choice(options).exclude, MotionChoice{}.exclude);
  EXPECT_TRUE(motion_choice(options).include.empty());
  options.include = " walk, sit down ,,";
  EXPECT_EQ(motion_choice(options).include, (std::vector<std::string>{"walk", "sit down"}));
}

TEST(Recipe, RequiresMotionsIfItMentionsThem) {
  PoseOptions options;
  EXPECT_FALSE(asks_for_motions(options)) << "the default takes them where they are";
  options.captured = 0.5F;
  EXPECT_TRUE(asks_for_motions(options));
  options = {};
  options.include = "walk";
  EXPECT_TRUE(asks_for_motions(options));
  options.captured = 0.F;
  EXPECT_FALSE(asks_for_motions(options));
}

}  // namespace
}  // namespace vesalius::synth
