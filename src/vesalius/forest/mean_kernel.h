#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "vesalius/forest/smooth_window.h"
#include "vesalius/image.h"
#include "vesalius/labeller.h"

namespace vesalius {

/// Calls `use(nu, nv)` for every neighbour of (u, v), itself included, inside window, picture and depth gate.
template <class Use>
void for_neighbours(const DepthImage& depth, int u, int v, const SmoothWindow& window, Use&& use) {
  const auto first_inside = [&](int at) {
    while (at < 0) at += window.spacing;
    return at;
  };
  const int reach = window.reach();
  const int z = depth(u, v);
  const int left = first_inside(u - reach), right = std::min(depth.width() - 1, u + reach);
  const int bottom = std::min(depth.height() - 1, v + reach);
  for (int nv = first_inside(v - reach); nv <= bottom; nv += window.spacing) {
    const std::uint16_t* row = depth.row(nv);
    for (int nu = left; nu <= right; nu += window.spacing) {
      if (row[nu] != 0 && std::abs(row[nu] - z) <= window.gate_mm) use(nu, nv);
    }
  }
}

/// Writes rows `begin` to `end` - 1 of mean_filter (smooth_labels.h) to `out`, which has the size of `posteriors`:
/// means rounded down, zero without a reading, the same from every instruction set. No sum over a window may exceed
/// 65535.
void mean_rows(const Posteriors& posteriors, const DepthImage& depth, const SmoothWindow& window, int begin, int end,
               Posteriors& out);

}  // namespace vesalius
