#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "vesalius/image.h"

namespace vesalius {

// Reading. All functions throw Error naming the file (`name`) and what was expected if the file cannot be read, is
// empty, truncated, damaged, of another kind, or larger than kMaxPixels.

/// Reads a 16-bit grey PNG. The values are those stored, in whatever unit the file uses.
Image<std::uint16_t> read_png16(const std::string& path);
Image<std::uint16_t> decode_depth_png(std::string_view bytes, const std::string& name);

/// Reads an 8-bit grey PNG, such as a mask or a label picture.
Image<std::uint8_t> read_png8(const std::string& path);

/// Reads a PNG or JPEG of any kind, or a PPM, as 8-bit colour. Transparency and orientation tags are ignored.
ColourImage read_colour(const std::string& path);
ColourImage decode_colour(std::string_view bytes, const std::string& name);

// Writing is lossless and atomic (io/files/atomic_file.h). All functions throw Error naming the path.

std::string encode_png(const Image<std::uint16_t>& image);  ///< 16-bit grey
std::string encode_png(const Image<std::uint8_t>& image);   ///< 8-bit grey
std::string encode_png(const ColourImage& image);           ///< 8-bit RGB

/// Returns a JPEG of this quality, 1-100, for pictures to look at.
std::string encode_jpeg(const ColourImage& image, int quality);

void write_png(const Image<std::uint16_t>& image, const std::string& path);
void write_png(const Image<std::uint8_t>& image, const std::string& path);
void write_png(const ColourImage& image, const std::string& path);

}  // namespace vesalius
