#pragma once

#include <algorithm>
#include <cstdint>

#include "vesalius/image.h"

namespace vesalius {

/// Steps that places in pictures are given in, to a pixel.
inline constexpr int kPlaceBits = 8;
inline constexpr std::int32_t kPlaceSteps = 1 << kPlaceBits;
/// A place outside of every picture.
inline constexpr std::int32_t kNoPlace = -(1 << 30);

/// Returns `pixels` in steps. Places beyond 2^22 pixels, and those that are no numbers, are kNoPlace.
template <class Real>
inline std::int32_t to_place(Real pixels) {
  constexpr Real kMost = Real(1 << 22);
  if (!(pixels > -kMost && pixels < kMost)) return kNoPlace;
  const Real steps = pixels * Real(kPlaceSteps) + Real(0.5);
  const auto whole = static_cast<std::int32_t>(steps);
  return whole - (static_cast<Real>(whole) > steps ? 1 : 0);
}

/// Returns the number of the pixel that a place lies in.
inline std::int32_t pixel_of(std::int32_t place) { return (place + kPlaceSteps / 2) >> kPlaceBits; }

/// Returns the colour of a place between the four pixels around it. It must lie in a pixel of the picture.
inline Rgb colour_between(const ColourImage& picture, std::int32_t u, std::int32_t v) {
  u = std::clamp(u, 0, (picture.width() - 1) << kPlaceBits);
  v = std::clamp(v, 0, (picture.height() - 1) << kPlaceBits);
  const int left = u >> kPlaceBits, top = v >> kPlaceBits;
  const int right = std::min(left + 1, picture.width() - 1), bottom = std::min(top + 1, picture.height() - 1);
  const int fu = u & (kPlaceSteps - 1), fv = v & (kPlaceSteps - 1);
  const Rgb* above = picture.row(top);
  const Rgb* below = picture.row(bottom);
  const auto mixed = [&](std::uint8_t Rgb::*of) {
    const int upper = above[left].*of * (kPlaceSteps - fu) + above[right].*of * fu;
    const int lower = below[left].*of * (kPlaceSteps - fu) + below[right].*of * fu;
    return static_cast<std::uint8_t>((upper * (kPlaceSteps - fv) + lower * fv + (1 << (2 * kPlaceBits - 1))) >>
                                     (2 * kPlaceBits));
  };
  return {mixed(&Rgb::r), mixed(&Rgb::g), mixed(&Rgb::b)};
}

}  // namespace vesalius
