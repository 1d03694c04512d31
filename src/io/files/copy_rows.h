#pragma once

#include <cstddef>
#include <cstring>

#include "vesalius/image.h"

namespace vesalius {

/// Fills a picture from rows in memory whose beginnings lie `stride` bytes apart.
template <class T>
void copy_rows(const void* data, std::size_t stride, Image<T>& to) {
  const auto* row = static_cast<const char*>(data);
  for (int v = 0; v < to.height(); ++v, row += stride) {
    std::memcpy(static_cast<void*>(to.row(v)), row, static_cast<std::size_t>(to.width()) * sizeof(T));
  }
}

}  // namespace vesalius
