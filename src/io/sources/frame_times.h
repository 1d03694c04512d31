#pragma once

#include <cstddef>

#include "vesalius/frame_source.h"

namespace vesalius {

/// Returns when frame `index` counts as taken where the frames have no times.
inline double usual_time_s(std::size_t index) { return double(index) / kUsualRate; }

/// Returns the index of the first of `count` frames that is not before `time_s`, or `count`. `time_of` gives the time
/// of the frame with an index; times must not fall.
template <class TimeOf>
std::size_t first_not_before(double time_s, std::size_t count, const TimeOf& time_of) {
  std::size_t first = 0;
  while (count > 0) {
    const std::size_t half = count / 2;
    if (time_of(first + half) < time_s) {
      first += half + 1;
      count -= half + 1;
    } else {
      count = half;
    }
  }
  return first;
}

}  // namespace vesalius
