#pragma once

#include <cstdint>
#include <vector>

#include "vesalius/image.h"
#include "vesalius/label_pixels.h"

namespace vesalius {

/// Which neighbours a mean is over: those of a square around the pixel, itself among them, whose depth differs from its
/// depth by at most `gate_mm`.
struct MeanWindow {
  int each_way = 0;  ///< neighbours to each side, upwards and downwards
  int spacing = 1;   ///< pixels from one neighbour to the next
  int gate_mm = 0;

  int reach() const { return each_way * spacing; }
  /// The first neighbour of column or row `at` that is in the picture.
  int first(int at) const {
    int first = at - reach();
    while (first < 0) first += spacing;
    return first;
  }
  int most() const { return (2 * each_way + 1) * (2 * each_way + 1); }
};

/// Whether `mean_rows` can do it: the sum over a whole window fits into 16 bits and the classes fill a vector.
bool mean_rows_fit(const Posteriors& posteriors, const MeanWindow& window);

/// Rows `begin` to `end` - 1 of mean_filter (smooth_labels.h), rounded down; zero without a reading. `out` is of the
/// same size. The same from every instruction set.
void mean_rows(const Posteriors& posteriors, const DepthImage& depth, const MeanWindow& window, int begin, int end,
               Posteriors& out);

}  // namespace vesalius
