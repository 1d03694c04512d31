#pragma once

#include <cstddef>
#include <cstdint>

namespace vesalius {

/// Whether `best_classes` can do it: the classes fill a vector.
bool best_classes_fit(int classes);

/// For `count` pixels in a row, `stride` sums each, of which the first `classes` count: the class of the largest sum,
/// the lowest of equal ones, and 1 in `unsure` where the second largest is above zero and less than `margin` below it.
/// Where all are zero or `skip` is 1 `best` becomes kBackground and `unsure` 0. The same from every instruction set.
void best_classes(const std::uint16_t* sums, std::size_t stride, int classes, const std::uint8_t* skip, int count,
                  std::uint32_t margin, std::uint8_t* best, std::uint8_t* unsure);

}  // namespace vesalius
