#pragma once

#include <cstdint>
#include <vector>

#include "vesalius/image.h"
#include "vesalius/label_pixels.h"

namespace vesalius {

/// Whether `mean_rows` can do it: the sum over a whole window fits into 16 bits and the classes fill a vector.
bool mean_rows_fit(const Posteriors& posteriors, int window);

/// Rows `begin` to `end` - 1 of mean_filter (smooth_labels.h): over neighbours in a `window` x `window` square whose
/// depth differs by at most `gate_mm`, rounded down; zero without a reading. `out` is of the same size. The same from
/// every instruction set.
void mean_rows(const Posteriors& posteriors, const DepthImage& depth, int window, int gate_mm, int begin, int end,
               Posteriors& out);

}  // namespace vesalius
