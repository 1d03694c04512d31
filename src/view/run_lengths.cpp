#include "view/run_lengths.h"

#include <algorithm>

namespace vesalius {
namespace {

constexpr int kDigitBits = 7;
constexpr unsigned kMore = 1U << kDigitBits;

}  // namespace

std::string pack_runs(const Image<std::uint8_t>& image) {
  std::string packed;
  const std::uint8_t* const end = image.data() + image.size();
  for (const std::uint8_t* at = image.data(); at != end;) {
    const std::uint8_t value = *at;
    const std::uint8_t* const next = std::find_if(at, end, [value](std::uint8_t v) { return v != value; });
    packed += static_cast<char>(value);
    auto length = static_cast<std::size_t>(next - at);
    for (; length >= kMore; length >>= kDigitBits) packed += static_cast<char>(length % kMore + kMore);
    packed += static_cast<char>(length);
    at = next;
  }
  return packed;
}

}  // namespace vesalius
