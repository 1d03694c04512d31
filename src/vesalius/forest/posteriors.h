#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "vesalius/base/image.h"

namespace vesalius {

/// P(c | x) of every pixel, as sums over the trees of probabilities in 1/255: `classes` values a pixel, pixel after
/// pixel. Body parts come first, then the background where the forest has one. All are zero where depth has no reading.
struct Posteriors {
  int width = 0;
  int height = 0;
  int classes = 0;
  int trees = 0;  ///< sums / (255 * trees) are probabilities
  std::vector<std::uint16_t> sums;
  /// 1 on settled pixels: the labeller was so sure of the background around them that it gave them what a neighbour
  /// has. They are background, and smoothing leaves them as they are. Empty where the labeller looked at every pixel.
  Mask settled = {};

  const std::uint16_t* at(int u, int v) const {
    return sums.data() + (static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u)) *
                             static_cast<std::size_t>(classes);
  }
  std::uint16_t* at(int u, int v) { return const_cast<std::uint16_t*>(std::as_const(*this).at(u, v)); }

  /// Makes room for as many numbers as `other` has and settles the same pixels. What the numbers are is left open.
  void resize_like(const Posteriors& other) {
    width = other.width;
    height = other.height;
    classes = other.classes;
    trees = other.trees;
    settled = other.settled;
    sums.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * static_cast<std::size_t>(classes));
  }
};

}  // namespace vesalius
