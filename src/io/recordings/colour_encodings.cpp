#include "io/recordings/colour_encodings.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "io/files/plain_text.h"
#include "io/files/rgb_of_yuv.h"
#include "io/recordings/picture_message.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using Bytes = const std::uint8_t*;

/// Channels of a pixel beside each other: bytes of a pixel, where red, green and blue stand, bytes of a channel.
struct PackedColour {
  std::string_view name;
  int bytes, r, g, b, channel_bytes = 1;
  bool is_grey() const { return bytes == channel_bytes; }
};
constexpr std::array<PackedColour, 16> kPackedColours{{{"rgb8", 3, 0, 1, 2},
                                                       {"bgr8", 3, 2, 1, 0},
                                                       {"8uc3", 3, 2, 1, 0},
                                                       {"rgba8", 4, 0, 1, 2},
                                                       {"bgra8", 4, 2, 1, 0},
                                                       {"8uc4", 4, 2, 1, 0},
                                                       {"mono8", 1, 0, 0, 0},
                                                       {"8uc1", 1, 0, 0, 0},
                                                       {"gray", 1, 0, 0, 0},
                                                       {"rgb16", 6, 0, 2, 4, 2},
                                                       {"bgr16", 6, 4, 2, 0, 2},
                                                       {"16uc3", 6, 4, 2, 0, 2},
                                                       {"rgba16", 8, 0, 2, 4, 2},
                                                       {"bgra16", 8, 4, 2, 0, 2},
                                                       {"mono16", 2, 0, 0, 0, 2},
                                                       {"16uc1", 2, 0, 0, 0, 2}}};
/// Two pixels share their chrominance: where in their four bytes the first luminance, U and V stand.
struct Pairs {
  std::string_view name;
  int y, u, v;
};
constexpr std::array<Pairs, 5> kPairs{
    {{"yuv422", 1, 0, 2}, {"uyvy", 1, 0, 2}, {"yuv422_yuy2", 0, 1, 3}, {"yuyv", 0, 1, 3}, {"yuy2", 0, 1, 3}}};
/// Luminance of all pixels, then chrominance of each four: both in one plane, or each in its own.
struct Planes {
  std::string_view name;
  bool together, v_first;
};
constexpr std::array<Planes, 4> kPlanes{
    {{"nv12", true, false}, {"nv21", true, true}, {"i420", false, false}, {"yv12", false, true}}};
/// Each pixel has one colour: those of two by two pixels.
constexpr std::array<std::string_view, 4> kBayer{"rggb", "bggr", "gbrg", "grbg"};
constexpr std::string_view kBayerPrefix = "bayer_";

template <class Table>
const auto* row_of(const Table& table, std::string_view name) {
  const auto found = std::ranges::find(table, name, &Table::value_type::name);
  return found == table.end() ? nullptr : &*found;
}

/// Returns the pattern of "bayer_rggb8", or nothing.
std::string_view bayer_pattern(std::string_view name) {
  if (!name.starts_with(kBayerPrefix)) return {};
  name.remove_prefix(kBayerPrefix.size());
  const auto found = std::ranges::find(kBayer, name.substr(0, 4));
  return found != kBayer.end() && (name.substr(4) == "8" || name.substr(4) == "16") ? *found : std::string_view();
}

Bytes row_of(const PictureMessage& picture, int v) {
  return reinterpret_cast<Bytes>(picture.data.data()) + static_cast<std::size_t>(v) * picture.row_bytes;
}

/// `colour_at` gets the beginning of a pixel's row, and its place.
template <class ColourAt>
ColourImage make_colour(const PictureMessage& picture, const ColourAt& colour_at) {
  ColourImage colour(picture.width, picture.height);
  for (int v = 0; v < picture.height; ++v) {
    const Bytes row = row_of(picture, v);
    for (int u = 0; u < picture.width; ++u) colour(u, v) = colour_at(row, u, v);
  }
  return colour;
}

/// `high` is where in a channel its upper eight bits stand.
ColourImage from_packed(const PictureMessage& picture, const PackedColour& of, int high, const std::string& name) {
  expect_rows(picture, static_cast<std::size_t>(of.bytes), name);
  return make_colour(picture, [&](Bytes row, int u, int) {
    const Bytes pixel = row + u * of.bytes + high;
    return Rgb{pixel[of.r], pixel[of.g], pixel[of.b]};
  });
}

ColourImage from_pairs(const PictureMessage& picture, const Pairs& of, const std::string& name) {
  expect_rows(picture, 2, name);
  if (picture.width % 2 != 0) {
    throw Error(fmt::format("{}: {} of {} columns, expected an even number", name, picture.encoding, picture.width));
  }
  return make_colour(picture, [&](Bytes row, int u, int) {
    const Bytes pair = row + 4 * (u / 2);
    return rgb_of_yuv(pair[of.y + 2 * (u % 2)], pair[of.u], pair[of.v]);
  });
}

ColourImage from_planes(const PictureMessage& picture, const Planes& of, const std::string& name) {
  expect_rows(picture, 1, name);
  const auto row_bytes = static_cast<std::size_t>(picture.row_bytes), height = std::size_t(picture.height);
  if (picture.width % 2 != 0 || picture.height % 2 != 0 || picture.data.size() < row_bytes * (height + height / 2)) {
    throw Error(fmt::format("{}: {} of {}x{} with {} bytes, expected even sides and {} bytes", name, picture.encoding,
                            picture.width, picture.height, picture.data.size(), row_bytes * (height + height / 2)));
  }
  const Bytes first = row_of(picture, picture.height);
  const std::size_t chroma_row = of.together ? row_bytes : row_bytes / 2;
  const Bytes second = of.together ? first + 1 : first + chroma_row * (height / 2);
  const int step = of.together ? 2 : 1;
  return make_colour(picture, [&](Bytes row, int u, int v) {
    const std::size_t at = chroma_row * std::size_t(v / 2) + std::size_t(u / 2 * step);
    return rgb_of_yuv(row[u], (of.v_first ? second : first)[at], (of.v_first ? first : second)[at]);
  });
}

/// Gives every pixel the colours of its two by two.
ColourImage from_bayer(const PictureMessage& picture, std::string_view pattern, int bytes, int high,
                       const std::string& name) {
  expect_rows(picture, static_cast<std::size_t>(bytes), name);
  if (picture.width < 2 || picture.height < 2) throw Error(name + ": a Bayer pattern of less than 2x2 pixels");
  return make_colour(picture, [&](Bytes, int u, int v) {
    const int left = std::min(u / 2 * 2, (picture.width - 2) / 2 * 2),
              top = std::min(v / 2 * 2, (picture.height - 2) / 2 * 2);
    int r = 0, g = 0, b = 0;
    for (int i = 0; i < 4; ++i) {
      const int value = row_of(picture, top + i / 2)[(left + i % 2) * bytes + high];
      (pattern[std::size_t(i)] == 'r' ? r : pattern[std::size_t(i)] == 'g' ? g : b) += value;
    }
    return Rgb{static_cast<std::uint8_t>(r), static_cast<std::uint8_t>(g / 2), static_cast<std::uint8_t>(b)};
  });
}

}  // namespace

bool is_colour_encoding(std::string_view encoding) {
  const std::string name = lower(encoding);
  return row_of(kPackedColours, name) != nullptr || row_of(kPairs, name) != nullptr ||
         row_of(kPlanes, name) != nullptr || !bayer_pattern(name).empty();
}

bool is_grey_encoding(std::string_view encoding) {
  const PackedColour* packed = row_of(kPackedColours, lower(encoding));
  return packed != nullptr && packed->is_grey();
}

ColourImage decode_raw_colour(const PictureMessage& picture, const std::string& name) {
  const std::string encoding = lower(picture.encoding);
  const int high = picture.big_endian ? 0 : 1;
  if (const auto* of = row_of(kPackedColours, encoding)) {
    return from_packed(picture, *of, of->channel_bytes == 1 ? 0 : high, name);
  }
  if (const auto* of = row_of(kPairs, encoding)) return from_pairs(picture, *of, name);
  if (const auto* of = row_of(kPlanes, encoding)) return from_planes(picture, *of, name);
  if (const std::string_view pattern = bayer_pattern(encoding); !pattern.empty()) {
    const bool is_16 = encoding.ends_with("16");
    return from_bayer(picture, pattern, is_16 ? 2 : 1, is_16 ? high : 0, name);
  }
  throw Error(fmt::format("{}: colour encoded as \"{}\", expected RGB, grey, Bayer or YUV", name, picture.encoding));
}

}  // namespace vesalius
