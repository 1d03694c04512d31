#pragma once

#include <cstddef>
#include <string>

namespace vesalius {

/// Largest file that is read whole.
inline constexpr std::size_t kMaxFileBytes = std::size_t{1} << 30;

/// The bytes of a regular file. Throws Error naming `path` when there is none, it cannot be read, is no regular file
/// (a pipe would block), or has more than `max_bytes` bytes.
std::string read_file(const std::string& path, std::size_t max_bytes = kMaxFileBytes);

}  // namespace vesalius
