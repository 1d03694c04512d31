#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace vesalius {

/// Largest picture that is decoded: a header can claim any size.
inline constexpr std::int64_t kMaxPixels = std::int64_t{64} << 20;

/// What a PNG's header says, and the PNG without the chunks that do not matter to its pixels.
struct PngBytes {
  int width = 0;
  int height = 0;
  int bit_depth = 0;
  int colour_type = 0;  ///< 0 grey, 2 RGB, 3 palette, 4 grey + alpha, 6 RGB + alpha
  std::string pixels;   ///< IHDR, PLTE, IDAT and IEND only: profiles and texts cannot upset the decoder
};

/// Walks all chunks before anything is decoded. Throws Error naming `name` for a file that is empty, no PNG,
/// truncated, damaged (checksums), too large, or too short for the size it claims.
PngBytes check_png(std::string_view bytes, const std::string& name);

/// Walks all segments of a JPEG up to the end marker, for decoders pad a truncated one with grey. Throws Error naming
/// `name` for a file that is truncated, has no or too large a size, or more scans than any real encoder makes.
void check_jpeg(std::string_view bytes, const std::string& name);

bool is_png(std::string_view bytes);
bool is_jpeg(std::string_view bytes);

}  // namespace vesalius
