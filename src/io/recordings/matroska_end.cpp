#include "io/recordings/matroska_end.h"

namespace vesalius {
namespace {

/// Takes a number of EBML from `bytes`: its first bit that is set says how many bytes it has. Identifiers keep that
/// bit, sizes do not, and one of ones alone is not known.
std::optional<std::uint64_t> take_number(std::string_view& bytes, bool is_size) {
  constexpr unsigned kMostBytes = 8;
  if (bytes.empty()) return std::nullopt;
  const auto first = static_cast<unsigned char>(bytes[0]);
  unsigned count = 1;
  while (count <= kMostBytes && (first & (0x80U >> (count - 1))) == 0) ++count;
  if (count > kMostBytes || count > bytes.size()) return std::nullopt;
  const unsigned mask = is_size ? 0xFFU >> count : 0xFFU;
  std::uint64_t value = first & mask, ones = mask;
  for (unsigned i = 1; i < count; ++i) {
    value = value << 8U | static_cast<unsigned char>(bytes[i]);
    ones = ones << 8U | 0xFFU;
  }
  bytes.remove_prefix(count);
  if (is_size && value == ones) return std::nullopt;
  return value;
}

}  // namespace

std::optional<std::uint64_t> stated_matroska_end(std::string_view head) {
  constexpr std::uint64_t kSegment = 0x18538067;
  std::string_view left = head;
  while (!left.empty()) {
    const auto id = take_number(left, false);
    const auto size = id ? take_number(left, true) : std::nullopt;
    if (!size) return std::nullopt;
    if (*id == kSegment) return head.size() - left.size() + *size;
    if (*size > left.size()) return std::nullopt;
    left.remove_prefix(*size);
  }
  return std::nullopt;
}

}  // namespace vesalius
