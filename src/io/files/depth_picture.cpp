#include "io/files/depth_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "io/files/av_pictures.h"
#include "io/files/data_file.h"
#include "io/files/image_bytes.h"
#include "io/files/stored_depth.h"
#include "vesalius/error.h"
#include "vesalius/image_file.h"

namespace vesalius {
namespace {

using namespace std::literals;

static_assert(std::endian::native == std::endian::little, "arrays of NumPy say which end comes first");

constexpr float kMost = std::numeric_limits<std::uint16_t>::max();
constexpr std::string_view kNumpy = "\x93NUMPY"sv;

/// Returns values of type T from `from` on, as those of a picture.
template <class T, class Pixel>
Image<Pixel> pixels(std::string_view from, int width, int height, bool swapped) {
  Image<Pixel> image(width, height);
  for (std::size_t i = 0; i < image.size(); ++i) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, from.data() + i * sizeof(T), sizeof(T));
    if (swapped) std::reverse(bytes, bytes + sizeof(T));
    const T value = std::bit_cast<T>(bytes);
    if constexpr (std::is_integral_v<T>) {
      image[i] = value < T{0} || std::uint64_t(value) > std::uint64_t(kMost) ? Pixel{0} : static_cast<Pixel>(value);
    } else {
      image[i] = Pixel(value);
    }
  }
  return image;
}

Image<std::uint16_t> decode_pgm(std::string_view bytes, const std::string& name) {
  const PnmHeader header = check_pnm(bytes, 1, name);
  if (header.most <= 0xFF) throw Error(name + ": 8-bit PGM, expected 16-bit (depth, 0 = no reading)");
  return pixels<std::uint16_t, std::uint16_t>(bytes.substr(header.begin), header.width, header.height, true);
}

/// "Pf", sides, a number that is negative where the low byte comes first, and rows from the lowest up.
DepthPicture decode_pfm(std::string_view bytes, const std::string& name) {
  std::array<std::string_view, 3> words;
  std::size_t at = 2;
  for (std::string_view& word : words) {
    at = bytes.find_first_not_of(" \t\r\n", at);
    const std::size_t end = std::min(bytes.find_first_of(" \t\r\n", at), bytes.size());
    if (at >= end) throw Error(name + ": truncated PFM");
    word = bytes.substr(at, end - at);
    at = end;
  }
  int width = 0, height = 0;
  std::from_chars(words[0].data(), words[0].data() + words[0].size(), width);
  std::from_chars(words[1].data(), words[1].data() + words[1].size(), height);
  check_image_size(width, height, name);
  const std::size_t expected = std::size_t(width) * std::size_t(height) * sizeof(float);
  if (bytes.size() < at + 1 + expected) {
    throw Error(fmt::format("{}: truncated: {} bytes, expected {} for {}x{} pixels", name, bytes.size(),
                            at + 1 + expected, width, height));
  }
  auto image = pixels<float, float>(bytes.substr(at + 1), width, height, !words[2].starts_with('-'));
  for (int v = 0; v < height / 2; ++v) std::swap_ranges(image.row(v), image.row(v) + width, image.row(height - 1 - v));
  return {{}, std::move(image)};
}

/// Returns why a TIFF is not read; empty where nothing in its first directory speaks against it.
std::string_view why_no_tiff(std::string_view bytes) {
  const auto number = [&](std::size_t at, std::size_t count) {
    std::size_t value = 0;
    for (std::size_t i = 0; i < count && at + count <= bytes.size(); ++i) {
      const std::size_t byte = bytes.front() == 'M' ? i : count - 1 - i;
      value = value << 8U | static_cast<unsigned char>(bytes[at + byte]);
    }
    return value;
  };
  constexpr std::size_t kSampleFormat = 339, kFloats = 3, kEntry = 12;
  const std::size_t directory = number(4, 4), entries = number(directory, 2);
  for (std::size_t i = 0; i < entries; ++i) {
    const std::size_t at = directory + 2 + kEntry * i, place = number(at + 4, 4) > 2 ? number(at + 8, 4) : at + 8;
    if (number(at, 2) == kSampleFormat && number(place, 2) == kFloats) {
      return "TIFF of floats, which is not read; write metres as .npy: python3 -c \"import cv2, numpy; "
             "numpy.save('out.npy', cv2.imread('in.tif', -1))\"";
    }
  }
  const bool is_first = number(directory + 2 + kEntry * entries, 4) != 0;
  return is_first ? "TIFF of several pictures, expected a file for each" : "";
}

/// Returns what stands between `begin` and `end` in the header of an array; empty where nothing does.
std::string_view between(std::string_view text, std::string_view begin, std::string_view end) {
  const std::size_t from = text.find(begin);
  if (from == text.npos) return {};
  text.remove_prefix(from + begin.size());
  return text.substr(0, text.find(end));
}

/// Returns the sides of an array without those of 1 around rows and columns. A list is one row.
std::vector<int> shape_of(std::string_view text) {
  std::vector<int> sides;
  for (std::size_t at = 0; at < text.size();) {
    int side = 0;
    const auto [stop, error] = std::from_chars(text.data() + at, text.data() + text.size(), side);
    if (error == std::errc()) sides.push_back(side);
    at = std::max(at + 1, std::size_t(stop - text.data()));
  }
  if (sides.size() == 3) std::erase(sides, 1);
  if (sides.size() == 1) sides.insert(sides.begin(), 1);
  return sides;
}

DepthPicture decode_numpy(std::string_view bytes, const std::string& name) {
  constexpr std::size_t kVersion1 = 10, kVersion2 = 12;
  if (bytes.size() < kVersion2) throw Error(name + ": truncated array of NumPy");
  const auto byte = [&](std::size_t i) { return std::size_t(static_cast<unsigned char>(bytes[i])); };
  const bool is_first = byte(6) == 1;
  const std::size_t begin = is_first ? kVersion1 : kVersion2;
  const std::size_t length = byte(8) | byte(9) << 8U | (is_first ? 0 : byte(10) << 16U | byte(11) << 24U);
  if (length > bytes.size() - begin) throw Error(name + ": truncated array of NumPy");
  const std::string_view header = bytes.substr(begin, length), data = bytes.substr(begin + length);
  const std::string_view type = between(header, "'descr': '", "'"), shape = between(header, "'shape': (", ")");
  const std::vector<int> sides = shape_of(shape);
  if (sides.size() != 2 || between(header, "'fortran_order': ", ",") != "False") {
    throw Error(fmt::format("{}: array of ({}), expected rows of columns of one picture", name, shape));
  }
  check_image_size(sides[1], sides[0], name);
  const std::size_t size = type.size() == 3 ? std::size_t(type[2] - '0') : 0;
  const std::size_t expected = std::size_t(sides[0]) * std::size_t(sides[1]) * size;
  if (size <= 8 && data.size() < expected) {
    throw Error(fmt::format("{}: truncated: {} bytes of pixels, expected {}", name, data.size(), expected));
  }
  const bool swapped = type.starts_with('>');
  const auto whole = [&]<class T>(T) {
    return DepthPicture{pixels<T, std::uint16_t>(data, sides[1], sides[0], swapped), {}};
  };
  const auto real = [&]<class T>(T) { return DepthPicture{{}, pixels<T, float>(data, sides[1], sides[0], swapped)}; };
  const std::string_view kind = type.substr(std::min<std::size_t>(1, type.size()));
  if (kind == "u2") return whole(std::uint16_t{});
  if (kind == "i2") return whole(std::int16_t{});
  if (kind == "u4") return whole(std::uint32_t{});
  if (kind == "i4") return whole(std::int32_t{});
  if (kind == "i8") return whole(std::int64_t{});
  if (kind == "f4") return real(float{});
  if (kind == "f8") return real(double{});
  throw Error(fmt::format("{}: array of {}, expected uint16 (depth) or float32 (metres)", name, type));
}

}  // namespace

const std::vector<std::string>& depth_extensions() {
  static const std::vector<std::string> without{".png", ".pgm", ".npy", ".pfm"};
  static const std::vector<std::string> with{".png", ".pgm", ".npy", ".pfm", ".tif", ".tiff", ".exr"};
  return has_avcodec() ? with : without;
}

const std::vector<std::string>& unread_depth_extensions() {
  static const std::vector<std::string> all{".tif", ".tiff", ".exr", ".npz",  ".mat", ".h5",   ".hdf5", ".raw",
                                            ".bin", ".dpt",  ".jp2", ".sens", ".svo", ".svo2", ".xef",  ".klg"};
  return all;
}

std::string unread_advice(const std::string& extension) {
  const std::string what = fmt::format("depth of {}, expected PNG", extension);
  const bool metres = extension == ".exr";
  if (metres || extension.starts_with(".tif")) {
    return fmt::format("{}; convert: python3 -c \"import cv2; cv2.imwrite('out.png', ({}).astype('uint16'))\"", what,
                       metres ? fmt::format("cv2.imread('in{}', -1) * 1000", extension)
                              : fmt::format("cv2.imread('in{}', -1)", extension));
  }
  if (extension == ".sens") {
    return what + "; ScanNet's reader.py: --export_depth_images --export_color_images --export_intrinsics";
  }
  if (extension.starts_with(".svo")) return what + "; write depth and left pictures by ZED's sample SVO Export";
  return what + " of 16 bits, PGM or .npy; convert it";
}

DepthPicture decode_depth(std::string_view bytes, const std::string& name) {
  if (is_pgm(bytes)) return {decode_pgm(bytes, name), {}};
  if (bytes.starts_with("Pf")) return decode_pfm(bytes, name);
  if (bytes.starts_with("PF")) throw Error(name + ": PFM of colours, expected one of one channel");
  if (bytes.starts_with(kNumpy)) return decode_numpy(bytes, name);
  if (is_jpeg(bytes)) throw Error(name + ": JPEG, which loses depth, expected a PNG of 16 bits");
  if (const std::string_view kind = av_picture_kind(bytes); !kind.empty()) {
    const bool may_be = kind == "TIFF" || kind == "OpenEXR";
    if (!may_be) throw Error(fmt::format("{}: {} of 8 bits, expected 16 or floats", name, kind));
    if (!has_avcodec()) throw Error(fmt::format("{}: {}", name, unread_advice(kind == "TIFF" ? ".tif" : ".exr")));
    const std::string_view why = kind == "TIFF" ? why_no_tiff(bytes) : "";
    if (!why.empty()) throw Error(fmt::format("{}: {}", name, why));
    AvPicture picture = decode_av_picture(bytes, name);
    if (!picture.colour.empty())
      throw Error(fmt::format("{}: {} of 8 bits or colours, expected grey of 16", name, kind));
    return {std::move(picture.whole), std::move(picture.real)};
  }
  return {decode_depth_png(bytes, name), {}};
}

DepthPicture read_depth(const std::string& path) { return decode_depth(read_file(path), path); }

bool may_be_depth(const std::string& path) try {
  constexpr std::size_t kHeader = 512, kBits = 24, kColours = 25;  // of a PNG
  const std::string first = DataFile(path).read(0, kHeader);
  if (is_png(first) && first.size() > kColours) return first[kBits] == 16 && first[kColours] == 0;
  if (is_pgm(first)) return pnm_header(first).most > 0xFF;
  return !is_ppm(first) && !is_jpeg(first);
} catch (const Error&) {
  return true;
}

DepthImage to_millimetres(const DepthPicture& picture, float units_per_m, bool of_real) {
  if (!picture.real.empty()) {
    const float mm_per_unit = of_real ? 1000.F / units_per_m : 1000.F;
    DepthImage depth(picture.width(), picture.height());
    std::ranges::transform(picture.real, depth.begin(), [mm_per_unit](float units) {
      const float mm = std::round(units * mm_per_unit);
      return mm >= 1.F && mm <= kMost ? static_cast<std::uint16_t>(mm) : std::uint16_t{0};
    });
    return depth;
  }
  const double mm_per_unit = 1000.0 / units_per_m;
  DepthImage depth(picture.width(), picture.height());
  if (mm_per_unit == 1.0) {
    std::ranges::replace_copy(picture.whole, depth.begin(), kNoReading, std::uint16_t{0});
    return depth;
  }
  std::ranges::transform(picture.whole, depth.begin(), [mm_per_unit](std::uint16_t units) {
    const double mm = std::round(units * mm_per_unit);
    return mm > kMost || units == kNoReading ? std::uint16_t{0} : static_cast<std::uint16_t>(mm);
  });
  return depth;
}

}  // namespace vesalius
