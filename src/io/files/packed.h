#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "io/files/byte_stream.h"

namespace vesalius {

/// Bytes compressed by zstd as files hold them: u32 size, u32 compressed size, zstd frame. Level 1 is quick, 19 small
/// and about 100 times slower; reading takes the same time. The same bytes give the same file for one version of zstd.
std::string pack(std::string_view raw, int level);

/// Throws Error unless there are `smallest` to `largest` bytes, before it allocates any, and for what is no zstd frame
/// of that size. `what` names them.
std::string read_packed(ByteReader& in, std::size_t smallest, std::size_t largest, const char* what);

}  // namespace vesalius
