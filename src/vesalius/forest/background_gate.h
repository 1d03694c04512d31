#pragma once

#include <cstdint>
#include <vector>

#include "vesalius/base/image.h"
#include "vesalius/forest/posteriors.h"

namespace vesalius {

/// Whether a pixel is one of every `step`-th column and row.
inline bool on_grid(int step, int u, int v) { return u % step == 0 && v % step == 0; }

/// Gives a pixel between those of the grid the sums of that one around it whose depth is nearest. False where none is
/// within 5 cm.
bool take_from_grid(const DepthImage& depth, int step, int u, int v, Posteriors& out);

/// Where a forest that was asked on a grid is sure of the background.
class BackgroundGate {
 public:
  static constexpr int kStep = 4;

  /// `posteriors` hold at least the pixels of the grid; their last class is the background. Sure is a probability of
  /// `least` or more.
  BackgroundGate(const DepthImage& depth, const Posteriors& posteriors, float least);

  /// For every pixel of a row 1 where the pixels of the grid around it (itself, if it is one) are sure. Those without a
  /// reading do not count, unless none has one.
  void row(int v, std::uint8_t* shut) const;

 private:
  enum State : std::uint8_t { kNoReading = 0, kSure = 1, kUnsure = 3 };  ///< of several together: the bits of all

  int width_;
  Image<std::uint8_t> states_;  ///< of the grid
};

}  // namespace vesalius
