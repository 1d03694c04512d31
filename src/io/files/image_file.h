#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "vesalius/base/image.h"

namespace vesalius {

// Reading. All throw Error naming the file (`name`) and what was expected: for a file that cannot be read, is empty,
// truncated, damaged, of another kind, or larger than kMaxPixels.

/// 16-bit grey PNG as stored, whatever its unit.
Image<std::uint16_t> read_png16(const std::string& path);
Image<std::uint16_t> decode_depth_png(std::string_view bytes, const std::string& name);

/// 8-bit grey PNG: a mask or a label picture.
Image<std::uint8_t> read_png8(const std::string& path);

/// PNG or JPEG of any kind as 8-bit colour; transparency and orientation tags are ignored.
ColourImage read_colour(const std::string& path);
ColourImage decode_colour(std::string_view bytes, const std::string& name);

// Writing, lossless and atomic (io/atomic_file.h). All throw Error naming the path.

std::string encode_png(const Image<std::uint16_t>& image);  ///< 16-bit grey
std::string encode_png(const Image<std::uint8_t>& image);   ///< 8-bit grey
std::string encode_png(const ColourImage& image);           ///< 8-bit RGB

void write_png(const Image<std::uint16_t>& image, const std::string& path);
void write_png(const Image<std::uint8_t>& image, const std::string& path);
void write_png(const ColourImage& image, const std::string& path);

}  // namespace vesalius
