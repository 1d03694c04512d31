#include "synth/sensor/noise_colour.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "synth/sensor/noise_field.h"

namespace vesalius::synth {
namespace {

constexpr double kExposure = 0.15;                 // sigma of the logarithm of the gain
constexpr double kBalance = 0.04;                  // sigma of the logarithm between channels
constexpr double kQuietest = 2.0, kLoudest = 6.0;  // sigma of a pixel, of 255

std::uint8_t clipped(int value) { return static_cast<std::uint8_t>(value < 0 ? 0 : value > 255 ? 255 : value); }

/// The values of a camera's channels by those of the scene.
using Gains = std::array<std::array<int, 256>, 3>;

Gains draw_gains(Random& random) {
  const double exposure = random.normal(0.0, kExposure);
  Gains gained{};
  for (auto& channel : gained) {
    const double gain = std::exp(exposure + random.normal(0.0, kBalance));
    for (std::size_t i = 0; i < channel.size(); ++i) {
      channel[i] = int(std::min(255.0, std::round(gain * double(i))));
    }
  }
  return gained;
}

void apply(const Gains& gained, float sigma, ColourImage& colour, Random& random) {
  const auto noise = [&] { return int(std::lround(sigma * quick_normal(random))); };
  for (Rgb& pixel : colour) {
    pixel.r = clipped(gained[0][pixel.r] + noise());
    pixel.g = clipped(gained[1][pixel.g] + noise());
    pixel.b = clipped(gained[2][pixel.b] + noise());
  }
}

}  // namespace

void add_colour_noise(ColourImage& colour, Random random) {
  const Gains gained = draw_gains(random);
  const auto sigma = float(random.uniform(kQuietest, kLoudest));
  apply(gained, sigma, colour, random);
}

void add_colour_noise(ColourImage& colour, Random look, Random noise) {
  const Gains gained = draw_gains(look);
  const auto sigma = float(look.uniform(kQuietest, kLoudest));
  apply(gained, sigma, colour, noise);
}

}  // namespace vesalius::synth
