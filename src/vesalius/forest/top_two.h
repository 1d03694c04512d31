#pragma once

#include <cstddef>
#include <cstdint>

namespace vesalius {

/// The two largest sums of a pixel. All three members are 0 where all sums are.
struct TopTwo {
  std::uint16_t first = 0;
  std::uint16_t second = 0;  ///< equal to the first if two are largest
  std::uint16_t best = 0;    ///< class of the first; the lowest of equal ones
};

/// Writes the two largest sums of `count` pixels in a row to `top`, except for pixels where `skip` is 1. Each pixel has
/// `stride` sums, of which the first `classes` (at least 1) count. The result is the same for every instruction set.
void find_top_two(const std::uint16_t* sums, std::size_t stride, int classes, const std::uint8_t* skip, int count,
                  TopTwo* top);

}  // namespace vesalius
