#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "io/files/byte_stream.h"

namespace vesalius {

/// Compresses bytes with zstd in the form that files store: u32 size, u32 compressed size, zstd frame. Level 1 is fast;
/// level 19 gives the smallest result and takes about 100 times as long. The level does not affect the reading time.
/// One version of zstd always compresses the same bytes to the same result.
std::string pack(std::string_view raw, int level);

/// Reads and decompresses what `pack` wrote. Throws Error before allocating memory if the stated size is not within
/// `smallest` and `largest` bytes, and if the data is not a zstd frame of that size. `what` names the data in errors.
std::string read_packed(ByteReader& in, std::size_t smallest, std::size_t largest, const char* what);

}  // namespace vesalius
