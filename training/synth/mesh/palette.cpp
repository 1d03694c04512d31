#include "synth/mesh/palette.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vesalius::synth {
namespace {

/// Returns the sRGB of hue (0-1, cyclic), saturation and value (0-1).
Rgb from_hsv(double hue, double saturation, double value) {
  const auto channel = [&](double shift) {
    const double k = std::fmod(shift + hue * 6.0, 6.0);
    const double c = value - value * saturation * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0);
    return static_cast<std::uint8_t>(std::clamp(c * 255.0 + 0.5, 0.0, 255.0));
  };
  return {channel(5.0), channel(3.0), channel(1.0)};
}

/// The ranges from which the look of a stuff is drawn.
struct Range {
  double hue_low, hue_high, saturation_low, saturation_high, value_low, value_high;
  double infrared_low, infrared_high;
  double pattern;  ///< share that has a pattern
  double period_low_m, period_high_m;
};

Range range_of(Stuff stuff) {
  switch (stuff) {
    case Stuff::wood:
      return {0.05, 0.11, 0.25, 0.7, 0.25, 0.85, 0.4, 0.8, 0.6, 0.01, 0.05};
    case Stuff::cloth:
      return {0.0, 1.0, 0.0, 0.75, 0.15, 0.9, 0.35, 0.85, 0.4, 0.02, 0.12};
    case Stuff::paint:
      return {0.0, 1.0, 0.0, 0.5, 0.3, 0.95, 0.4, 0.85, 0.05, 0.1, 0.3};
    case Stuff::metal:
      return {0.55, 0.65, 0.0, 0.1, 0.15, 0.75, 0.1, 0.5, 0.0, 0.1, 0.1};
    case Stuff::plastic:
      return {0.0, 1.0, 0.0, 0.6, 0.08, 0.9, 0.08, 0.8, 0.05, 0.05, 0.2};
    case Stuff::leaf:
      return {0.22, 0.4, 0.35, 0.8, 0.25, 0.65, 0.5, 0.8, 0.3, 0.02, 0.05};
    case Stuff::cardboard:
      return {0.07, 0.1, 0.35, 0.55, 0.5, 0.75, 0.5, 0.75, 0.1, 0.05, 0.2};
    case Stuff::wall:
      return {0.0, 1.0, 0.0, 0.25, 0.6, 0.97, 0.55, 0.85, 0.2, 0.1, 0.4};
    case Stuff::floor:
      return {0.03, 0.13, 0.05, 0.6, 0.25, 0.8, 0.3, 0.75, 0.7, 0.08, 0.5};
    case Stuff::glass:
      return {0.55, 0.65, 0.0, 0.3, 0.03, 0.2, 0.02, 0.12, 0.0, 0.1, 0.1};
  }
  return {};
}

}  // namespace

Material sample_material(Stuff stuff, Random& random) {
  const Range range = range_of(stuff);
  const double hue = random.uniform(range.hue_low, range.hue_high);
  const double saturation = random.uniform(range.saturation_low, range.saturation_high);
  const double value = random.uniform(range.value_low, range.value_high);
  Material material;
  material.colour = from_hsv(hue, saturation, value);
  material.second = material.colour;
  material.infrared = between(range.infrared_low, range.infrared_high, random);
  // Some cloth is leather or black, since whole sofas lack depth in real frames.
  if (stuff == Stuff::cloth && chance(0.2, random)) {
    material.infrared = float(std::exp(random.uniform(std::log(0.01), std::log(0.2))));
  }
  material.period_m = between(range.period_low_m, range.period_high_m, random);
  if (!chance(range.pattern, random)) return material;
  constexpr std::array<Texture, 3> kPatterns = {Texture::stripes, Texture::checks, Texture::speckle};
  material.texture = stuff == Stuff::wood ? Texture::stripes : kPatterns[random.below(3)];
  const double contrast = stuff == Stuff::cloth ? random.uniform(0.3, 1.4) : random.uniform(0.75, 1.1);
  material.second = from_hsv(hue, saturation, std::min(1.0, value * contrast));
  return material;
}

Rgb mix(const Rgb& from, const Rgb& to, float share) {
  const auto channel = [&](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>(std::lround(std::lerp(float(a), float(b), share)));
  };
  return {channel(from.r, to.r), channel(from.g, to.g), channel(from.b, to.b)};
}

Rgb scaled(const Rgb& colour, float factor) {
  const auto channel = [&](std::uint8_t c) { return static_cast<std::uint8_t>(std::min(255.F, factor * float(c))); };
  return {channel(colour.r), channel(colour.g), channel(colour.b)};
}

Rgb skin_colour(Random& random) { return mix({70, 45, 32}, {240, 205, 185}, float(random.uniform())); }

}  // namespace vesalius::synth
