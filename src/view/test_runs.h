#pragma once

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "vesalius/image.h"

namespace vesalius::test {

/// Unpacks a picture of runs (run_lengths.h) as the page does it. Throws unless the runs fill it exactly.
inline Image<std::uint8_t> unpack_runs(std::string_view packed, int width, int height) {
  Image<std::uint8_t> image(width, height);
  std::size_t filled = 0;
  for (std::size_t at = 0; at < packed.size();) {
    const auto value = static_cast<std::uint8_t>(packed.at(at++));
    std::size_t length = 0;
    unsigned digit = 128;
    for (int shift = 0; digit >= 128; shift += 7) {
      digit = static_cast<unsigned char>(packed.at(at++));
      length |= static_cast<std::size_t>(digit % 128) << shift;
    }
    if (length > image.size() - filled) throw std::runtime_error("more pixels than the picture has");
    std::fill_n(image.data() + filled, length, value);
    filled += length;
  }
  if (filled != image.size()) throw std::runtime_error("fewer pixels than the picture has");
  return image;
}

}  // namespace vesalius::test
