#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace vesalius {

/// Bytes of a file's beginning that have what `stated_matroska_end` looks for.
inline constexpr std::size_t kMatroskaHead = 4096;

/// Returns where a file of Matroska ends by what it says itself, in bytes; nothing if it does not know, as one that was
/// never completed. `head` is its beginning.
std::optional<std::uint64_t> stated_matroska_end(std::string_view head);

}  // namespace vesalius
