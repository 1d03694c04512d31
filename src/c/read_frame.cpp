#include "c/read_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string>
#include <type_traits>
#include <utility>

#include "c/guard.h"
#include "vesalius/base/depth_reading.h"
#include "vesalius/error.h"

namespace vesalius::c {
namespace {

constexpr std::size_t kMostCameras = 8;

/// The rows of a picture of the caller's, which need not be aligned.
template <class T>
class Rows {
 public:
  Rows(const void* first, std::int64_t stride, std::size_t values, const char* name)
      : first_(static_cast<const unsigned char*>(first)), values_(values) {
    const auto bytes = static_cast<std::int64_t>(values * sizeof(T));
    stride_ = stride != 0 ? stride : bytes;
    if (stride_ > -bytes && stride_ < bytes) {
      throw UsageError(std::string(name) + "_stride is " + std::to_string(stride) + ", expected 0 or at least " +
                       std::to_string(bytes) + " bytes, the length of a row");
    }
  }
  void copy(int row, T* to) const {
    std::memcpy(to, first_ + static_cast<std::ptrdiff_t>(row) * stride_, values_ * sizeof(T));
  }

 private:
  const unsigned char* first_;
  std::size_t values_;
  std::int64_t stride_;
};

[[noreturn]] void throw_unknown(const char* what, std::int32_t found, int last) {
  throw UsageError(std::string(what) + " is " + std::to_string(found) + ", expected 0 to " + std::to_string(last));
}

DepthImage read_depth(const vesalius_frame& given, const Camera& camera) {
  need(static_cast<const unsigned char*>(given.depth), "frame: depth");
  DepthImage depth(camera.width, camera.height);
  const auto width = static_cast<std::size_t>(camera.width);
  if (given.depth_format == VESALIUS_DEPTH_MILLIMETRES) {
    const Rows<std::uint16_t> rows(given.depth, given.depth_stride, width, "frame: depth");
    for (int v = 0; v < camera.height; ++v) rows.copy(v, depth.row(v));
  } else if (given.depth_format == VESALIUS_DEPTH_METRES) {
    const Rows<float> rows(given.depth, given.depth_stride, width, "frame: depth");
    std::vector<float> metres(width);
    for (int v = 0; v < camera.height; ++v) {
      rows.copy(v, metres.data());
      std::transform(metres.begin(), metres.end(), depth.row(v), depth_reading);
    }
  } else {
    throw_unknown("frame: depth_format", given.depth_format, VESALIUS_DEPTH_METRES);
  }
  return depth;
}

/// Where red and blue are, and how many bytes a pixel has.
struct ColourFormat {
  std::size_t red, blue, bytes;
};
constexpr std::array<ColourFormat, 4> kColourFormats{{{0, 2, 3}, {2, 0, 3}, {0, 2, 4}, {2, 0, 4}}};
static_assert(VESALIUS_COLOUR_RGB == 0 && VESALIUS_COLOUR_BGR == 1 && VESALIUS_COLOUR_RGBA == 2 &&
              VESALIUS_COLOUR_BGRA == 3);

ColourImage read_colour(const vesalius_frame& given, const Camera& camera) {
  if (given.colour == nullptr) return {};
  if (given.colour_format < 0 || given.colour_format > VESALIUS_COLOUR_BGRA) {
    throw_unknown("frame: colour_format", given.colour_format, VESALIUS_COLOUR_BGRA);
  }
  const auto [red, blue, bytes] = kColourFormats[static_cast<std::size_t>(given.colour_format)];
  const std::size_t row_bytes = static_cast<std::size_t>(camera.width) * bytes;
  const Rows<std::uint8_t> rows(given.colour, given.colour_stride, row_bytes, "frame: colour");
  ColourImage colour(camera.width, camera.height);
  std::vector<std::uint8_t> row(row_bytes);
  for (int v = 0; v < camera.height; ++v) {
    rows.copy(v, row.data());
    const std::uint8_t* pixel = row.data();
    for (Rgb* to = colour.row(v); to != colour.row(v) + camera.width; ++to, pixel += bytes) {
      *to = {pixel[red], pixel[1], pixel[blue]};
    }
  }
  return colour;
}

/// A kind of lens: its name for make_lens and how many coefficients it has.
struct LensKind {
  const char* name;
  std::size_t coefficients;
};
constexpr std::array<LensKind, 4> kLenses{
    {{"pinhole", 0}, {"rational_polynomial", 8}, {"modified_brown_conrady", 5}, {"kannala_brandt", 4}}};
static_assert(VESALIUS_LENS_PINHOLE == 0 && VESALIUS_LENS_BROWN_CONRADY == 1 &&
              VESALIUS_LENS_MODIFIED_BROWN_CONRADY == 2 && VESALIUS_LENS_KANNALA_BRANDT == 3);

Lens read_lens(const vesalius_camera& given) {
  if (given.lens < 0 || given.lens > VESALIUS_LENS_KANNALA_BRANDT) {
    throw_unknown("camera: lens", given.lens, VESALIUS_LENS_KANNALA_BRANDT);
  }
  const auto [name, count] = kLenses[static_cast<std::size_t>(given.lens)];
  for (std::size_t i = 0; i < std::size(given.distortion); ++i) {
    const double value = given.distortion[i];
    if (!std::isfinite(value) || (i >= count && value != 0.0)) {
      throw UsageError("camera: distortion[" + std::to_string(i) + "] is " + std::to_string(value) + ", expected " +
                       (i >= count ? "0 for this lens" : "a finite number"));
    }
  }
  if (count == 0) return {};
  const auto lens = make_lens(name, std::vector<double>(given.distortion, given.distortion + count));
  if (!lens) throw UsageError("camera: no lens has this distortion");
  return *lens;
}

std::optional<Eigen::Vector3f> read_up(const vesalius_frame& given) {
  if (given.has_up == 0) return std::nullopt;
  const Eigen::Vector3f up(given.up[0], given.up[1], given.up[2]);
  const float length = up.norm();
  if (!std::isfinite(length) || length <= 0.F)
    throw UsageError("frame: up is no direction, expected a finite length above 0");
  return up / length;
}

}  // namespace

std::shared_ptr<const Rectification> Rectifications::of(const LensCamera& camera) const {
  const std::scoped_lock lock(mutex_);
  const auto found = std::ranges::find_if(entries_, [&](const Entry& entry) {
    return entry.camera.camera == camera.camera && entry.camera.lens == camera.lens;
  });
  if (found != entries_.end()) {
    std::rotate(found, found + 1, entries_.end());
  } else {
    entries_.push_back({camera, std::make_shared<const Rectification>(camera, camera.camera)});
    if (entries_.size() > kMostCameras) entries_.erase(entries_.begin());
  }
  return entries_.back().rectification;
}

LensCamera read_camera(const vesalius_camera* given) {
  const vesalius_camera camera = read_struct(given, "camera");
  if (camera.width < 1 || camera.height < 1 || camera.width > kMostSide || camera.height > kMostSide) {
    throw UsageError("camera: picture size " + std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                     ", expected 1 to " + std::to_string(kMostSide) + " a side");
  }
  LensCamera read{{camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy}, {}};
  try {
    check(read.camera);
  } catch (const Error& e) {
    throw UsageError(e.what());
  }
  read.lens = read_lens(camera);
  return read;
}

Frame read_frame(const vesalius_frame* given, const vesalius_camera* camera, const Rectifications& rectifications) {
  const vesalius_frame values = read_struct(given, "frame");
  const LensCamera seen = read_camera(camera);
  Frame frame;
  frame.camera = seen.camera;
  frame.depth = read_depth(values, seen.camera);
  frame.colour = read_colour(values, seen.camera);
  if (values.has_time != 0) {
    if (!std::isfinite(values.time_s)) throw UsageError("frame: time_s is not finite, expected a number of seconds");
    frame.time_s = values.time_s;
  }
  frame.up = read_up(values);
  if (seen.lens.model != LensModel::pinhole) {
    const auto rectification = rectifications.of(seen);
    frame.depth = rectification->depth(frame.depth);
    if (!frame.colour.empty()) frame.colour = rectification->colour(frame.colour);
  }
  return frame;
}

}  // namespace vesalius::c
