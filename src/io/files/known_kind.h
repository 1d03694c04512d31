#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace vesalius {

/// Bytes of a file's beginning by which `known_kind` knows it.
inline constexpr std::size_t kKindBytes = 512;

/// Says what a file is that stands where another one is expected, and what to do: a pointer of Git LFS, an archive, a
/// web page, a film. Empty where its first bytes do not tell.
std::string_view known_kind(std::string_view first);

/// Returns `known_kind` of `first`, or `otherwise` where that does not tell.
std::string kind_or(std::string_view first, std::string_view otherwise);

}  // namespace vesalius
