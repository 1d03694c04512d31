#include "io/files/image_bytes.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cctype>
#include <charconv>

#include "io/files/known_kind.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using namespace std::literals;

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1a\n"sv;
constexpr int kMaxJpegScans = 100;  // progressive encoders write about ten

std::uint32_t byte_at(std::string_view bytes, std::size_t i) { return static_cast<unsigned char>(bytes[i]); }

std::uint32_t big_endian(std::string_view bytes, std::size_t at, int count) {
  std::uint32_t value = 0;
  for (int i = 0; i < count; ++i) value = value << 8U | byte_at(bytes, at + i);
  return value;
}

std::uint32_t checksum(std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

/// A chunk of a PNG. Its checksum has been verified.
struct Chunk {
  std::string_view type, data, whole;
};

Chunk chunk_at(std::string_view bytes, std::size_t at, const std::string& name) {
  const std::size_t left = bytes.size() - at;
  if (left < 12 || big_endian(bytes, at, 4) > left - 12) {
    throw Error(fmt::format("{}: truncated PNG: file ends at byte {} before the end chunk", name, bytes.size()));
  }
  const std::size_t length = big_endian(bytes, at, 4);
  if (checksum(bytes.substr(at + 4, length + 4)) != big_endian(bytes, at + 8 + length, 4)) {
    throw Error(fmt::format("{}: damaged PNG: wrong checksum of the chunk at byte {}", name, at));
  }
  return {bytes.substr(at + 4, 4), bytes.substr(at + 8, length), bytes.substr(at, length + 12)};
}

PngBytes parse_png_header(const Chunk& chunk, const std::string& name) {
  if (chunk.type != "IHDR" || chunk.data.size() != 13) {
    throw Error(name + ": damaged PNG: expected the header chunk at byte 8");
  }
  check_image_size(big_endian(chunk.data, 0, 4), big_endian(chunk.data, 4, 4), name);
  PngBytes png;
  png.width = int(big_endian(chunk.data, 0, 4));
  png.height = int(big_endian(chunk.data, 4, 4));
  png.bit_depth = int(byte_at(chunk.data, 8));
  png.colour_type = int(byte_at(chunk.data, 9));
  return png;
}

/// Throws if the compressed data is too short for the picture: deflate shrinks at most 1032 times (its longest match).
void check_data_size(const PngBytes& png, std::size_t data_bytes, const std::string& name) {
  const std::int64_t row_bytes = (std::int64_t{png.width} * png.bit_depth + 7) / 8;
  const std::int64_t least = row_bytes * png.height / 1032;
  if (data_bytes == 0 || static_cast<std::int64_t>(data_bytes) < least) {
    throw Error(fmt::format("{}: damaged PNG: {} bytes of picture data are too few for {}x{} pixels", name, data_bytes,
                            png.width, png.height));
  }
}

bool has_size(std::uint32_t jpeg_marker) {
  return jpeg_marker >= 0xC0 && jpeg_marker <= 0xCF && jpeg_marker != 0xC4 && jpeg_marker != 0xC8 &&
         jpeg_marker != 0xCC;
}

/// Returns the position of the first marker at or after `at`, not counting those within coded data; npos if there is
/// none.
std::size_t next_marker(std::string_view bytes, std::size_t at) {
  for (at = bytes.find('\xFF', at); at != bytes.npos && at + 1 < bytes.size(); at = bytes.find('\xFF', at + 1)) {
    const std::uint32_t marker = byte_at(bytes, at + 1);
    const bool in_data = marker == 0x00 || marker == 0xFF || (marker >= 0xD0 && marker <= 0xD7);
    if (!in_data) return at;
  }
  return bytes.npos;
}

/// Returns the next whole number of a header of a PNM, behind blanks and comments; 0 where there is none.
int next_number(std::string_view bytes, std::size_t& at) {
  while (at < bytes.size() && std::isspace(static_cast<unsigned char>(bytes[at])) != 0) {
    ++at;
    while (at < bytes.size() && bytes[at] == '#') at = std::min(bytes.find('\n', at), bytes.size());
  }
  int number = 0;
  const char* begin = bytes.data() + at;
  const auto [stop, error] = std::from_chars(begin, bytes.data() + bytes.size(), number);
  at += static_cast<std::size_t>(stop - begin);
  return error == std::errc() ? number : 0;
}

}  // namespace

void check_image_size(std::int64_t width, std::int64_t height, const std::string& name) {
  if (width < 1 || height < 1 || width > kMaxPixels / height) {
    throw Error(fmt::format("{}: picture of {}x{} pixels, expected 1 to {} in all", name, width, height, kMaxPixels));
  }
}

bool is_png(std::string_view bytes) { return bytes.starts_with(kPngSignature); }

bool is_jpeg(std::string_view bytes) { return bytes.starts_with("\xFF\xD8\xFF"sv); }

std::string_view av_picture_kind(std::string_view bytes) {
  if (bytes.starts_with("II*\0"sv) || bytes.starts_with("MM\0*"sv)) return "TIFF";
  if (bytes.starts_with("RIFF") && bytes.substr(0, 12).ends_with("WEBP")) return "WebP";
  if (bytes.starts_with("BM") && bytes.size() > 10 && bytes.substr(6, 4) == "\0\0\0\0"sv) return "BMP";
  return bytes.starts_with("\x76\x2f\x31\x01"sv) ? "OpenEXR" : "";
}

PngBytes check_png(std::string_view bytes, const std::string& name) {
  if (bytes.empty()) throw Error(name + ": empty file, expected a PNG");
  if (!is_png(bytes)) throw Error(fmt::format("{}: {}, expected a PNG", name, kind_or(bytes, "no PNG signature")));
  std::size_t at = kPngSignature.size();
  Chunk chunk = chunk_at(bytes, at, name);
  PngBytes png = parse_png_header(chunk, name);
  png.pixels.append(kPngSignature).append(chunk.whole);
  std::size_t data_bytes = 0;
  while (chunk.type != "IEND") {
    at += chunk.whole.size();
    chunk = chunk_at(bytes, at, name);
    if (chunk.type == "IDAT") data_bytes += chunk.data.size();
    if (chunk.type == "IDAT" || chunk.type == "PLTE" || chunk.type == "IEND") png.pixels.append(chunk.whole);
  }
  check_data_size(png, data_bytes, name);
  return png;
}

PnmHeader pnm_header(std::string_view bytes) {
  PnmHeader header;
  std::size_t at = 2;
  for (int* number : {&header.width, &header.height, &header.most}) *number = next_number(bytes, at);
  header.begin = at + 1;
  return header;
}

PnmHeader check_pnm(std::string_view bytes, int values, const std::string& name) {
  const PnmHeader header = pnm_header(bytes);
  check_image_size(header.width, header.height, name);
  if (header.most < 1 || header.most > 0xFFFF) throw Error(name + ": largest value expected to be 1 to 65535");
  const std::size_t expected =
      std::size_t(header.width) * std::size_t(header.height) * std::size_t(values) * (header.most > 0xFF ? 2 : 1);
  if (bytes.size() < header.begin + expected) {
    throw Error(fmt::format("{}: truncated: {} bytes, expected {} for {}x{} pixels", name, bytes.size(),
                            header.begin + expected, header.width, header.height));
  }
  return header;
}

void check_jpeg(std::string_view bytes, const std::string& name) {
  bool sized = false;
  int scans = 0;
  for (std::size_t at = next_marker(bytes, 2); at != bytes.npos;) {
    const std::uint32_t marker = byte_at(bytes, at + 1);
    if (marker == 0xD9) {
      if (!sized || scans == 0) throw Error(name + ": damaged JPEG: no picture before its end");
      return;
    }
    if (bytes.size() - at < 9) break;
    const std::size_t length = big_endian(bytes, at + 2, 2);
    if (length < 2 || length > bytes.size() - at - 2) break;
    if (has_size(marker)) {
      check_image_size(big_endian(bytes, at + 7, 2), big_endian(bytes, at + 5, 2), name);
      sized = true;
    }
    if (marker == 0xDA && ++scans > kMaxJpegScans) {
      throw Error(fmt::format("{}: JPEG of more than {} scans", name, kMaxJpegScans));
    }
    at = next_marker(bytes, at + 2 + length);
  }
  throw Error(fmt::format("{}: truncated JPEG: file ends at byte {} before the end marker", name, bytes.size()));
}

}  // namespace vesalius
