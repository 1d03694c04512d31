#pragma once

#include <cstdint>
#include <string>

#include "vesalius/image.h"

namespace vesalius {

/// Packs a picture as runs of equal values in row-major order: each is the value in one byte and the number of pixels
/// in base 128, low digits first, the highest bit set in all bytes but the last. Label pictures get a hundred times
/// smaller.
std::string pack_runs(const Image<std::uint8_t>& image);

}  // namespace vesalius
