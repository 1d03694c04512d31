#pragma once

#include <cstdint>

namespace vesalius {

/// Returns how far two times lie apart. Those of damaged files may be any number, whose difference no signed one holds.
inline std::uint64_t apart_ns(std::int64_t a, std::int64_t b) {
  const auto wrapped = static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b);
  return a > b ? wrapped : std::uint64_t{0} - wrapped;
}

}  // namespace vesalius
