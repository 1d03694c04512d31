#pragma once

#include <cstdint>
#include <vector>

#include "vesalius/base/image.h"
#include "vesalius/forest/posteriors.h"

namespace vesalius {

/// Gives pixel (u, v) the sums of that one of the grid's pixels around it whose depth is nearest. The grid is every
/// `step`-th pixel of every `step`-th row. Returns false, and changes nothing, where none is within 5 cm.
bool take_from_grid(const DepthImage& depth, int step, int u, int v, Posteriors& out);

/// Says where a forest that was asked on a grid is sure of the background.
class BackgroundGate {
 public:
  static constexpr int kStep = 4;

  /// `posteriors` hold at least the pixels of the grid; their last class is the background. The forest counts as sure
  /// where its probability is `least` or more.
  BackgroundGate(const DepthImage& depth, const Posteriors& posteriors, float least);

  /// Writes 1 for every pixel of row `v` where the forest is sure at all grid pixels around it, else 0. Grid pixels
  /// without a reading do not count; where none has one, 0 is written.
  void row(int v, std::uint8_t* shut) const;

 private:
  enum State : std::uint8_t { kNoReading = 0, kSure = 1, kUnsure = 3 };  ///< several pixels together: the bits of all

  int width_;
  Image<std::uint8_t> states_;  ///< of the grid
};

}  // namespace vesalius
