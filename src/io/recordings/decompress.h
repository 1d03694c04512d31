#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace vesalius {

/// Most bytes that one compressed piece of a recording may hold.
inline constexpr std::size_t kMaxPieceBytes = std::size_t{1} << 28;

/// Decompresses `packed`, whose `method` is "" or "none", "zstd", "lz4" (frames) or "bz2", into exactly `size` bytes.
/// Throws Error naming `name` if the method is another one, `size` is more than kMaxPieceBytes, or the data is damaged
/// or of another size. Memory grows with what comes out, not with what is stated.
std::string decompress(std::string_view packed, std::string_view method, std::size_t size, const std::string& name);

/// Returns the size that the header of a zstd frame states. Throws Error naming `name` if it states none.
std::size_t stated_zstd_size(std::string_view packed, const std::string& name);

}  // namespace vesalius
