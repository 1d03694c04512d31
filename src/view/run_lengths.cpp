#include "view/run_lengths.h"

#include <algorithm>

#include "vesalius/base/error.h"

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

Image<std::uint8_t> unpack_runs(std::string_view packed, int width, int height) {
  Image<std::uint8_t> image(width, height);
  std::size_t at = 0;
  std::size_t filled = 0;
  const auto byte = [&] {
    if (at == packed.size()) throw Error("runs of labels: cut short");
    return static_cast<unsigned char>(packed[at++]);
  };
  while (at < packed.size()) {
    const std::uint8_t value = byte();
    std::size_t length = 0;
    unsigned digit = kMore;
    for (int shift = 0; digit >= kMore; shift += kDigitBits) {
      if (shift > 28) throw Error("runs of labels: a run longer than any picture");
      digit = byte();
      length |= static_cast<std::size_t>(digit % kMore) << shift;
    }
    if (length > image.size() - filled) throw Error("runs of labels: more pixels than the picture has");
    std::fill_n(image.data() + filled, length, value);
    filled += length;
  }
  if (filled != image.size()) throw Error("runs of labels: fewer pixels than the picture has");
  return image;
}

}  // namespace vesalius
