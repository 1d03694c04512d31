#include "vesalius/appearance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <set>
#include <vector>

#include "vesalius/error.h"

namespace vesalius {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// Returns a flat grey picture in which `stripe` is added to the lightness of every second column from the middle on.
Frame striped(int stripe) {
  constexpr int kWidth = 40, kHeight = 20;
  Frame frame;
  frame.depth = DepthImage(kWidth, kHeight, 2000);
  frame.colour = ColourImage(kWidth, kHeight, Rgb{90, 90, 90});
  for (int v = 0; v < kHeight; ++v) {
    for (int u = kWidth / 2; u < kWidth; u += 2) {
      const auto light = static_cast<std::uint8_t>(90 + stripe);
      frame.colour(u, v) = {light, light, light};
    }
  }
  return frame;
}

std::uint16_t look_at(const Appearance& appearance, const Frame& frame, int u, int v) {
  return appearance.describe(frame)[static_cast<std::size_t>(v * frame.colour.width() + u)];
}

TEST(HueAppearance, WrapsHuesAndSortsGreysByLightness) {
  EXPECT_EQ(HueAppearance::class_of({200, 20, 20}), 0);
  EXPECT_EQ(HueAppearance::class_of({200, 20, 36}), 71);  // 355 degrees
  EXPECT_EQ(HueAppearance::class_of({20, 200, 20}), 24);  // 120 degrees
  EXPECT_EQ(HueAppearance::class_of({20, 20, 200}), 48);
  // Near-greys are sorted by lightness whatever their hue.
  EXPECT_EQ(HueAppearance::class_of({120, 118, 121}), HueAppearance::class_of({121, 120, 117}));
  EXPECT_GE(HueAppearance::class_of({120, 118, 121}), HueAppearance::kHues);
  EXPECT_NE(HueAppearance::class_of({30, 30, 30}), HueAppearance::class_of({220, 220, 220}));
}

TEST(AppearanceHistogram, BlursOverHuesThatLookAlike) {
  AppearanceHistogram histogram;
  for (int i = 0; i < 100; ++i) histogram.add(0);
  EXPECT_EQ(histogram.samples(), 100);
  const std::vector<float> p = histogram.probabilities(HueAppearance());
  EXPECT_GT(p[71], 10.F * p[36]);  // across 0 degrees
  EXPECT_NEAR(std::accumulate(p.begin(), p.end(), 0.F), 1.F, 1e-4F);
}

TEST(AppearanceHistogram, TakesAllLooksForAlikeWithoutSamples) {
  const HueAppearance hue;
  const std::vector<float> p = AppearanceHistogram().probabilities(hue);
  EXPECT_THAT(p, Each(p.front()));
}

TEST(TextureAppearance, TellsStripesFromPlainSurfacesOfTheirColour) {
  const TextureAppearance texture;
  std::set<std::uint16_t> looks;
  for (const int stripe : {2, 20, 60}) {
    const Frame frame = striped(stripe);
    EXPECT_EQ(look_at(texture, frame, 5, 10), HueAppearance::class_of({90, 90, 90})) << "plain, far from the stripes";
    looks.insert(look_at(texture, frame, 31, 10));  // a pixel of the same colour between two stripes
  }
  EXPECT_EQ(looks.size(), 3U);
  EXPECT_EQ(*looks.begin(), HueAppearance::class_of({90, 90, 90})) << "noise of a camera is no texture";
  EXPECT_LT(*looks.rbegin(), texture.classes());
}

TEST(TextureAppearance, KeepsOutlinesOutOfTheTextureOfASurface) {
  Frame frame = striped(0);
  for (int v = 0; v < frame.depth.height(); ++v) {
    for (int u = 20; u < frame.depth.width(); ++u) {
      frame.depth(u, v) = 1000;
      frame.colour(u, v) = {250, 250, 250};
    }
  }
  const TextureAppearance texture;
  EXPECT_EQ(look_at(texture, frame, 19, 10), HueAppearance::class_of({90, 90, 90}));
  EXPECT_EQ(look_at(texture, frame, 20, 10), HueAppearance::class_of({250, 250, 250}));
}

TEST(TextureAppearance, AveragesStepsOverFiveByFivePixels) {
  Frame frame = striped(0);
  frame.colour(10, 10) = {250, 250, 250};  // four steps of 160 among about fifty
  const TextureAppearance texture;
  const auto plain = HueAppearance::class_of({90, 90, 90});
  EXPECT_GT(look_at(texture, frame, 8, 8), plain);
  EXPECT_GT(look_at(texture, frame, 12, 12), plain);
  EXPECT_EQ(look_at(texture, frame, 7, 10), plain);
  EXPECT_EQ(look_at(texture, frame, 10, 14), plain);
}

TEST(Appearance, IsEmptyWithoutColour) {
  Frame dark = striped(60);
  dark.colour = {};
  EXPECT_TRUE(HueAppearance().describe(dark).empty());
  EXPECT_TRUE(TextureAppearance().describe(dark).empty());
  EXPECT_EQ(learn_appearance(dark, Mask(40, 20, 1), HueAppearance()).samples(), 0);
}

TEST(Appearance, HasAName) {
  EXPECT_EQ(make_appearance("hue")->classes(), HueAppearance::kClasses);
  EXPECT_EQ(make_appearance("texture")->classes(), 3 * HueAppearance::kClasses);
  EXPECT_EQ(make_appearance("none"), nullptr);
  EXPECT_THAT([] { make_appearance("smell"); },
              ThrowsMessage<UsageError>(HasSubstr("grow.appearance: expected hue, texture or none, found 'smell'")));
}

}  // namespace
}  // namespace vesalius
