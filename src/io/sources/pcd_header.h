#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace vesalius {

/// How a PCD file stores its points.
enum class PcdEncoding { ascii, binary, binary_compressed };

/// One field of a PCD file: `count` values of `size` bytes for each point.
struct PcdField {
  std::string name;
  std::uint32_t size = 4;
  char type = 'F';  ///< I signed, U unsigned, F floating point
  std::uint32_t count = 1;
  std::size_t offset = 0;  ///< bytes before it in a point
};

/// The header of a PCD file.
struct PcdHeader {
  std::vector<PcdField> fields;
  int width = 0;
  int height = 0;
  PcdEncoding encoding = PcdEncoding::ascii;
  std::array<int, 3> xyz{-1, -1, -1};  ///< indices of these fields
  int rgb = -1;                        ///< -1 = no colour
  std::size_t point_bytes = 0;
  std::size_t data_begin = 0;  ///< bytes before the first point

  std::size_t points() const { return std::size_t(width) * height; }
};

/// Reads the header of a PCD file. Throws Error naming `name` and the line if it is damaged or describes no organised
/// cloud.
PcdHeader parse_pcd_header(std::string_view bytes, const std::string& name);

}  // namespace vesalius
