#include "synth/sensor/colour_camera.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace vesalius::synth {
namespace {

/// Returns a picture of stripes, as wide as a texture may be.
ColourImage striped(int width, int height, int period) {
  ColourImage picture(width, height);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) picture(u, v) = (u / period) % 2 == 0 ? Rgb{200, 100, 60} : Rgb{40, 60, 120};
  }
  return picture;
}

/// Returns the mean difference of neighbours in rows.
double contrast(const ColourImage& picture) {
  double sum = 0.0;
  for (int v = 0; v < picture.height(); ++v) {
    for (int u = 1; u < picture.width(); ++u) sum += std::abs(picture(u, v).r - picture(u - 1, v).r);
  }
  return sum / double(picture.size());
}

TEST(ColourCamera, ChangesNothingByDefault) {
  for (std::uint64_t i = 0; i < 20; ++i) {
    const ColourCamera camera = draw_colour_camera({}, Random(1, i));
    EXPECT_EQ(camera.noise, 1.F);
    ColourImage picture = striped(40, 30, 4);
    expose(camera, picture);
    record(camera, picture);
    EXPECT_EQ(picture, striped(40, 30, 4));
  }
}

TEST(ColourCamera, StaysWithinItsRangesAndReachesThem) {
  const ColourCameraOptions options{.exposure_max = 2.F,
                                    .balance_max = 0.3F,
                                    .noise_max = 4.F,
                                    .blur_max_px = 3.F,
                                    .jpeg_worst = 30,
                                    .offset_max_px = 5};
  float brightest = 0.F, darkest = 9.F, warmest = 0.F, loudest = 0.F, blurred = 0.F;
  int worst = 100, left = 0, down = 0;
  for (std::uint64_t i = 0; i < 400; ++i) {
    const ColourCamera camera = draw_colour_camera(options, Random(2, i));
    brightest = std::max(brightest, camera.green_gain);
    darkest = std::min(darkest, camera.green_gain);
    warmest = std::max(warmest, camera.red_gain / camera.green_gain);
    EXPECT_NEAR(camera.red_gain + camera.blue_gain, 2.F * camera.green_gain, 1e-4F);
    loudest = std::max(loudest, camera.noise);
    EXPECT_GE(camera.noise, 1.F);
    blurred = std::max(blurred, camera.blur_px);
    worst = std::min(worst, camera.jpeg);
    left = std::min(left, camera.right);
    down = std::max(down, camera.down);
  }
  EXPECT_NEAR(brightest, 4.F, 0.2F);
  EXPECT_NEAR(darkest, 0.25F, 0.02F);
  EXPECT_NEAR(warmest, 1.3F, 0.02F);
  EXPECT_NEAR(loudest, 4.F, 0.2F);
  EXPECT_NEAR(blurred, 3.F, 0.1F);
  EXPECT_EQ(worst, 30);
  EXPECT_EQ(left, -5);
  EXPECT_EQ(down, 5);
}

TEST(ColourCamera, GainsClipAndBlurLevels) {
  ColourImage picture = striped(64, 32, 2);
  const double sharp = contrast(picture);
  expose({.red_gain = 2.F, .green_gain = 0.5F, .blue_gain = 1.F}, picture);
  EXPECT_EQ(picture(0, 0), (Rgb{255, 50, 60}));
  EXPECT_EQ(picture(2, 0), (Rgb{80, 30, 120}));
  picture = striped(64, 32, 2);
  expose({.blur_px = 2.F}, picture);
  EXPECT_LT(contrast(picture), 0.2 * sharp);
}

TEST(ColourCamera, JpegChangesColoursALittleAndTheSameEachTime) {
  ColourImage once = striped(64, 32, 4), again = once;
  const ColourImage before = once;
  record({.jpeg = 40}, once);
  record({.jpeg = 40}, again);
  EXPECT_EQ(once, again);
  EXPECT_NE(once, before);
  double difference = 0.0;
  for (std::size_t i = 0; i < once.size(); ++i) difference += std::abs(once[i].g - before[i].g);
  EXPECT_LT(difference / double(once.size()), 20.0);
}

TEST(ColourCamera, OffsetMovesThePictureAndRepeatsItsBorder) {
  ColourImage picture(4, 3);
  for (std::size_t i = 0; i < picture.size(); ++i) picture[i].r = static_cast<std::uint8_t>(i);
  const ColourImage before = picture;
  record({.right = 1, .down = -1}, picture);
  EXPECT_EQ(picture(1, 0), before(0, 1));
  EXPECT_EQ(picture(3, 1), before(2, 2));
  EXPECT_EQ(picture(0, 2), before(0, 2)) << "beyond the border its last pixel counts";
}

TEST(ColourNoise, KeepsTheGreyLevelsMeanAndSpreadWithinItsBounds) {
  double log_gain = 0.0;
  double log_square = 0.0;
  constexpr int kPictures = 400;
  for (std::uint64_t i = 0; i < kPictures; ++i) {
    ColourImage picture(32, 32, Rgb{100, 100, 100});
    add_colour_noise(picture, Random(1, i));
    double sum = 0.0;
    double square = 0.0;
    for (const Rgb& pixel : picture) {
      sum += pixel.g;
      square += pixel.g * pixel.g;
    }
    const double mean = sum / 1024.0;
    const double sigma = std::sqrt(square / 1024.0 - mean * mean);
    EXPECT_GT(sigma, 1.7);
    EXPECT_LT(sigma, 6.7);
    log_gain += std::log(mean / 100.0);
    log_square += std::log(mean / 100.0) * std::log(mean / 100.0);
  }
  EXPECT_NEAR(log_gain / kPictures, 0.0, 0.03);
  EXPECT_NEAR(std::sqrt(log_square / kPictures), std::hypot(0.15, 0.04), 0.02);
}

TEST(ColourNoise, ClipsInsteadOfWrapping) {
  ColourImage picture(64, 64, Rgb{255, 0, 255});
  add_colour_noise(picture, Random(2));
  for (const Rgb& pixel : picture) {
    EXPECT_GT(pixel.r, 120);
    EXPECT_LT(pixel.g, 40);
  }
}

TEST(ColourNoise, IsTheSameForTheSameSeed) {
  ColourImage a(20, 10, Rgb{10, 120, 200});
  ColourImage b = a;
  add_colour_noise(a, Random(3));
  add_colour_noise(b, Random(3));
  EXPECT_EQ(a, b);
  add_colour_noise(a, Random(3));
  EXPECT_NE(a, b);
}

}  // namespace
}  // namespace vesalius::synth
