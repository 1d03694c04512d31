#include "io/recordings/depth_codecs.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "io/files/byte_stream.h"
#include "io/files/image_bytes.h"
#include "vesalius/base/depth_reading.h"
#include "vesalius/error.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

/// Bytes before the PNG or RVL of compressedDepth.
constexpr std::size_t kCompressedDepthHead = 12;

/// Groups of four bits out of words of 32, the highest first: three of a number and one that says whether more follow.
class Nibbles {
 public:
  Nibbles(std::string_view bytes, const std::string& name) : in_(bytes, name) {}

  std::uint32_t number() {
    std::uint32_t value = 0;
    for (unsigned shift = 0; shift < 32; shift += 3) {
      if (left_ == 0) {
        word_ = in_.number<std::uint32_t>("RVL");
        left_ = 8;
      }
      const std::uint32_t nibble = word_ >> 28U;
      word_ <<= 4U;
      --left_;
      value |= (nibble & 7U) << shift;
      if ((nibble & 8U) == 0) return value;
    }
    in_.fail("a number of RVL does not fit 32 bits");
  }

 private:
  ByteReader in_;
  std::uint32_t word_ = 0;
  int left_ = 0;
};

class NibbleWriter {
 public:
  void number(std::uint32_t value) {
    do {
      const std::uint32_t nibble = (value & 7U) | (value > 7U ? 8U : 0U);
      value >>= 3U;
      word_ = word_ << 4U | nibble;
      if (++count_ == 8) flush();
    } while (value != 0);
  }
  std::string finish() {
    if (count_ > 0) {
      word_ <<= 4U * (8 - count_);
      flush();
    }
    return std::move(out_.bytes());
  }

 private:
  void flush() {
    out_.number(word_);
    word_ = 0;
    count_ = 0;
  }
  ByteWriter out_;
  std::uint32_t word_ = 0;
  unsigned count_ = 0;
};

void check_depth_size(std::int64_t width, std::int64_t height, const std::string& name) {
  if (width < 1 || height < 1 || width > kMaxPixels || height > kMaxPixels || width * height > kMaxPixels) {
    throw Error(
        fmt::format("{}: a depth picture of {}x{}, expected at most {} pixels", name, width, height, kMaxPixels));
  }
}

}  // namespace

Image<std::uint16_t> unpack_rvl(std::string_view packed, int width, int height, const std::string& name) {
  check_depth_size(width, height, name);
  Image<std::uint16_t> depth(width, height, 0);
  Nibbles in(packed, name);
  std::uint16_t* at = depth.data();
  std::uint16_t* const end = at + depth.size();
  std::uint32_t previous = 0;
  while (at != end) {
    const std::uint32_t empty = in.number();
    if (empty > static_cast<std::size_t>(end - at)) throw Error(name + ": RVL of more pixels than the picture has");
    at += empty;
    if (at == end) break;
    const std::uint32_t full = in.number();
    if (full > static_cast<std::size_t>(end - at)) throw Error(name + ": RVL of more pixels than the picture has");
    if (empty == 0 && full == 0) throw Error(name + ": RVL with a run of no pixels");
    for (std::uint32_t i = 0; i < full; ++i) {
      previous += static_cast<std::uint32_t>(unzigzag(in.number()));
      *at++ = static_cast<std::uint16_t>(previous);
    }
  }
  return depth;
}

std::string pack_rvl(const Image<std::uint16_t>& depth) {
  NibbleWriter out;
  const std::uint16_t* at = depth.data();
  const std::uint16_t* const end = at + depth.size();
  std::int32_t previous = 0;
  while (at != end) {
    const std::uint16_t* const start = at;
    while (at != end && *at == 0) ++at;
    out.number(static_cast<std::uint32_t>(at - start));
    const std::uint16_t* full_end = at;
    while (full_end != end && *full_end != 0) ++full_end;
    out.number(static_cast<std::uint32_t>(full_end - at));
    for (; at != full_end; ++at) {
      out.number(zigzag(*at - previous));
      previous = *at;
    }
  }
  return out.finish();
}

std::string_view without_compressed_depth_head(std::string_view data) {
  return is_png(data) ? data : data.substr(std::min(kCompressedDepthHead, data.size()));
}

std::pair<int, int> rvl_size(std::string_view data) {
  if (data.size() < kCompressedDepthHead + 2 * sizeof(std::uint32_t)) return {};
  const std::string name;
  ByteReader in(data.substr(kCompressedDepthHead), name);
  const auto side = [&] { return int(std::min<std::int64_t>(in.number<std::uint32_t>("size of RVL"), kMaxPixels)); };
  const int width = side();
  return {width, side()};
}

Image<std::uint16_t> unpack_compressed_depth(std::string_view data, std::string_view format, const std::string& name) {
  const bool is_float = format.starts_with("32FC1");
  if (is_png(data)) {
    if (is_float) throw Error(name + ": compressedDepth of 32FC1 without the 12 bytes that state its scale");
    return decode_depth_png(data, name);
  }
  ByteReader in(data, name);
  in.number<std::uint32_t>("kind of compressedDepth");
  const float scale = in.real32("scale of compressedDepth");
  const float offset = in.real32("offset of compressedDepth");
  Image<std::uint16_t> stored;
  if (format.find("rvl") != std::string_view::npos) {
    const auto width = in.number<std::uint32_t>("width of RVL");
    const auto height = in.number<std::uint32_t>("height of RVL");
    check_depth_size(width, height, name);
    stored = unpack_rvl(in.take(in.left(), "RVL"), int(width), int(height), name);
  } else {
    stored = decode_depth_png(in.take(in.left(), "PNG"), name);
  }
  if (!is_float) return stored;
  for (std::uint16_t& value : stored) {
    if (value == 0) continue;
    value = depth_reading_of_mm(1e3 * scale / (double(value) - offset));
  }
  return stored;
}

}  // namespace vesalius
