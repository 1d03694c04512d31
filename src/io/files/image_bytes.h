#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "vesalius/image.h"

namespace vesalius {

/// Largest picture, in pixels, that is decoded. A header can claim any size.
inline constexpr std::int64_t kMaxPixels = std::int64_t{64} << 20;

/// Returns the colour that points have in one number, 0xRRGGBB.
inline Rgb unpack_rgb(std::uint32_t packed) {
  return {static_cast<std::uint8_t>(packed >> 16U), static_cast<std::uint8_t>(packed >> 8U),
          static_cast<std::uint8_t>(packed)};
}

/// The header of a PNG, and its data without the chunks that do not affect the pixels.
struct PngBytes {
  int width = 0;
  int height = 0;
  int bit_depth = 0;
  int colour_type = 0;  ///< 0 grey, 2 RGB, 3 palette, 4 grey + alpha, 6 RGB + alpha
  std::string pixels;   ///< IHDR, PLTE, IDAT and IEND only, so profiles and texts cannot upset the decoder
};

/// Checks all chunks before anything is decoded. Throws Error naming `name` if the file is empty, not a PNG, truncated,
/// damaged (by its checksums), too large, or too short for the size it claims.
PngBytes check_png(std::string_view bytes, const std::string& name);

/// Checks all segments of a JPEG up to the end marker, because decoders fill a truncated picture with grey instead of
/// failing. Throws Error naming `name` if the file is truncated, states no size or too large a one, or has more scans
/// than any real encoder writes.
void check_jpeg(std::string_view bytes, const std::string& name);

/// The header of a PGM or PPM in binary.
struct PnmHeader {
  int width = 0, height = 0;
  int most = 0;           ///< largest value; of two bytes, the high one first, where it is over 255
  std::size_t begin = 0;  ///< of the pixels
};

/// Reads the header of a PGM ("P5") or PPM ("P6"); numbers that are missing are 0.
PnmHeader pnm_header(std::string_view bytes);

/// Reads the header of a PGM (`values` of a pixel 1) or PPM (3). Throws Error naming `name` if it is damaged, too
/// large, or the file too short for it.
PnmHeader check_pnm(std::string_view bytes, int values, const std::string& name);

/// Throws Error naming `name` unless a picture of this size has 1 to kMaxPixels pixels.
void check_image_size(std::int64_t width, std::int64_t height, const std::string& name);

bool is_png(std::string_view bytes);
bool is_jpeg(std::string_view bytes);
/// Returns the kind of a picture that libavcodec reads (io/files/av_pictures.h), by its first bytes: "TIFF", "WebP",
/// "BMP" or "OpenEXR"; nothing for others.
std::string_view av_picture_kind(std::string_view bytes);
inline bool is_pgm(std::string_view bytes) { return bytes.starts_with("P5"); }
inline bool is_ppm(std::string_view bytes) { return bytes.starts_with("P6"); }

/// Fills a picture from rows in memory whose beginnings lie `stride` bytes apart.
template <class T>
void copy_rows(const void* data, std::size_t stride, Image<T>& to) {
  const auto* row = static_cast<const char*>(data);
  for (int v = 0; v < to.height(); ++v, row += stride) {
    std::memcpy(static_cast<void*>(to.row(v)), row, static_cast<std::size_t>(to.width()) * sizeof(T));
  }
}

}  // namespace vesalius
