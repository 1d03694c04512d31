#pragma once

#include <cstdint>
#include <vector>

#include "vesalius/image.h"
#include "vesalius/labeller.h"

namespace vesalius {

/// Gives pixel (u, v) the sums of the surrounding grid pixel whose depth is nearest. The grid is every `step`-th pixel
/// of every `step`-th row. If none is within 5 cm, returns false and changes nothing.
bool take_from_grid(const DepthImage& depth, int step, int u, int v, Posteriors& out);

/// Tells where a forest that was asked on a grid is certain of the background.
class BackgroundGate {
 public:
  static constexpr int kStep = 4;
  /// Largest difference in depth between a pixel and a neighbour whose posteriors it takes. Parts of a body that are a
  /// hand's breadth apart are not one surface.
  static constexpr int kGuideMm = 50;

  /// Returns the sum of probabilities (Posteriors::whole) from which on the background is certain.
  static long enough(float least, int whole);

  /// `posteriors` have at least the pixels of the grid; their last class is the background. The forest is certain if
  /// that class has a probability of at least `least`.
  BackgroundGate(const DepthImage& depth, const Posteriors& posteriors, float least);

  /// Writes 1 for every pixel of row `v` if the forest is certain at all grid pixels around it, otherwise 0. Grid
  /// pixels without a reading are ignored; if none has one, 0 is written.
  void row(int v, std::uint8_t* shut) const;

 private:
  enum State : std::uint8_t {
    kNoReading = 0,
    kSure = 1,
    kUnsure = 3
  };  ///< several pixels together have the bits of all

  int width_;
  Image<std::uint8_t> states_;  ///< states of the grid's pixels
};

}  // namespace vesalius
