#pragma once

#include <fmt/format.h>
#include <lzf.h>

#include <bit>
#include <cstring>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

#include "io/sources/pcd_header.h"
#include "vesalius/frame.h"

namespace vesalius::test {

inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

inline std::uint32_t pack(Rgb colour) {
  return std::uint32_t{colour.r} << 16U | std::uint32_t{colour.g} << 8U | std::uint32_t{colour.b};
}

inline Eigen::Vector3f point_at(const Frame& frame, int u, int v) {
  const std::uint16_t depth_mm = frame.depth(u, v);
  if (depth_mm == 0) return {kNan, kNan, kNan};
  return frame.camera.point(float(u), float(v), float(depth_mm) / 1000.F);
}

inline std::string header(const Frame& frame, const char* encoding) {
  const bool colour = !frame.colour.empty();
  const char* fields = colour ? "FIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\n"
                              : "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";
  return fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n{}WIDTH {}\nHEIGHT {}\nVIEWPOINT 0 0 0 1 0 0 0\n"
      "POINTS {}\nDATA {}\n",
      fields, frame.depth.width(), frame.depth.height(), frame.depth.size(), encoding);
}

inline std::string ascii_points(const Frame& frame) {
  std::string text;
  auto out = std::back_inserter(text);
  for (int v = 0; v < frame.depth.height(); ++v) {
    for (int u = 0; u < frame.depth.width(); ++u) {
      const Eigen::Vector3f p = point_at(frame, u, v);
      fmt::format_to(out, "{} {} {}", p.x(), p.y(), p.z());
      if (!frame.colour.empty()) fmt::format_to(out, " {}", pack(frame.colour(u, v)));
      text += '\n';
    }
  }
  return text;
}

/// Returns the points' numbers as bytes. `point_step` is the distance in words from one point to the next, `field_step`
/// that from one field to the next.
inline std::string binary_points(const Frame& frame, std::size_t point_step, std::size_t field_step) {
  const std::size_t fields = frame.colour.empty() ? 3 : 4;
  std::vector<std::uint32_t> words(frame.depth.size() * fields);
  std::size_t at = 0;
  for (int v = 0; v < frame.depth.height(); ++v) {
    for (int u = 0; u < frame.depth.width(); ++u, at += point_step) {
      const Eigen::Vector3f p = point_at(frame, u, v);
      for (int axis = 0; axis < 3; ++axis) {
        words[at + axis * field_step] = std::bit_cast<std::uint32_t>(p[axis]);
      }
      if (fields == 4) words[at + 3 * field_step] = pack(frame.colour(u, v));
    }
  }
  std::string bytes(words.size() * sizeof(std::uint32_t), '\0');
  std::memcpy(bytes.data(), words.data(), bytes.size());
  return bytes;
}

inline std::string compressed_points(const Frame& frame) {
  const std::string plain = binary_points(frame, 1, frame.depth.size());
  // Data that cannot be compressed grows by one byte in 32.
  std::string packed(plain.size() + plain.size() / 16 + 64, '\0');
  const unsigned int packed_bytes = lzf_compress(plain.data(), static_cast<unsigned int>(plain.size()), packed.data(),
                                                 static_cast<unsigned int>(packed.size()));
  packed.resize(packed_bytes);
  const auto word = [](std::size_t value) {
    const auto narrow = static_cast<std::uint32_t>(value);
    std::string bytes(sizeof narrow, '\0');
    std::memcpy(bytes.data(), &narrow, sizeof narrow);
    return bytes;
  };
  return word(packed_bytes) + word(plain.size()) + packed;
}

/// Returns the frame as an organised PCD file with x y z, and rgb if the frame has colour, as PCL writes it. Pixels
/// without depth become NaN points.
inline std::string serialise_pcd(const Frame& frame, PcdEncoding encoding) {
  switch (encoding) {
    case PcdEncoding::ascii:
      return header(frame, "ascii") + ascii_points(frame);
    case PcdEncoding::binary:
      return header(frame, "binary") + binary_points(frame, frame.colour.empty() ? 3 : 4, 1);
    default:
      return header(frame, "binary_compressed") + compressed_points(frame);
  }
}

}  // namespace vesalius::test
