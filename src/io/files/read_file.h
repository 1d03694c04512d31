#pragma once

#include <cstddef>
#include <string>

namespace vesalius {

/// Largest file, in bytes, that is read as a whole.
inline constexpr std::size_t kMaxFileBytes = std::size_t{1} << 30;

/// Returns the bytes of a regular file. Throws Error naming `path` if it does not exist, cannot be read, is not a
/// regular file (reading a pipe would block), or is larger than `max_bytes`.
std::string read_file(const std::string& path, std::size_t max_bytes = kMaxFileBytes);

}  // namespace vesalius
