#include "synth/sensor/noise_colour.h"

#include <gmock/gmock.h>

#include <cmath>

namespace vesalius::synth {
namespace {

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
