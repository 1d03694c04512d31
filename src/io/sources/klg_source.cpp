#include "io/sources/klg_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

#include "io/files/byte_stream.h"
#include "io/files/data_file.h"
#include "io/files/image_bytes.h"
#include "io/files/image_file.h"
#include "io/recordings/decompress.h"
#include "io/sources/camera_file.h"
#include "io/sources/list_source.h"
#include "io/sources/timed_frames.h"

namespace vesalius {
namespace {

constexpr std::uint64_t kFileHead = 4, kFrameHead = 16;
constexpr std::size_t kDepthBytes = sizeof(std::uint16_t);
constexpr std::string_view kJpegMagic = "\xFF\xD8";

struct Size {
  int width = 0, height = 0;

  std::size_t pixels() const { return static_cast<std::size_t>(width) * static_cast<std::size_t>(height); }
};

/// Sizes of pictures of depth cameras, each with another number of pixels.
constexpr Size kUsualSizes[] = {{640, 480}, {320, 240}, {160, 120},  {1280, 960}, {1280, 720},  {512, 424},
                                {640, 360}, {848, 480}, {424, 240},  {480, 270},  {1280, 800},  {640, 576},
                                {320, 288}, {512, 512}, {1024, 768}, {960, 540},  {1024, 1024}, {1920, 1080}};

/// Where a frame lies in the file.
struct Place {
  std::uint64_t at = 0;  ///< of its depth; colour follows
  std::uint32_t depth_bytes = 0, colour_bytes = 0;
};

class KlgSource final : public TimedSource {
 public:
  KlgSource(const std::string& path, const SourceOptions& options) : file_(path) {
    find_frames();
    size_ = find_size(options);
    CameraFacts facts = find_camera_facts(options, {});
    units_per_m_ = facts.depth_scale.value_or(1000.F);
    if (!facts.fx && facts.sensor.empty() && size_.width == 640 && size_.height == 480) {
      CameraFacts usual;
      usual.fx = usual.fy = 528.F;
      usual.cx = 320.F;
      usual.cy = 240.F;
      facts.fill_from(usual);
      notes_.push_back(path + ": no intrinsics given; those of ElasticFusion (528, 528, 320, 240) assumed");
    }
    camera_ = resolve_camera(facts, size_.width, size_.height, true, path, notes_);
  }

  std::optional<Frame> next() override {
    if (next_ == places_.size()) return std::nullopt;
    const std::size_t index = next_++;
    const Place& place = places_[index];
    const std::string name = fmt::format("{}: {}", file_.path(), frames_.name(index));
    Frame frame = frame_at(index);
    frame.depth = depth_of(depth_bytes(place, name), name);
    if (place.colour_bytes > 0) frame.colour = colour_of(colour_bytes(place), name);
    return frame;
  }

 private:
  /// Reads the heads of all frames.
  void find_frames() {
    const std::string head = file_.read(0, kFileHead);
    if (head.size() < kFileHead) throw Error(file_.path() + ": no log of Kintinuous, expected a number of frames");
    const auto stated = ByteReader(head, file_.path()).number<std::uint32_t>("number of frames");
    std::vector<std::int64_t> times_us;
    std::uint64_t at = kFileHead;
    bool is_whole = true;
    // A log that was never closed states 0.
    while (at < file_.size() && (stated == 0 || places_.size() < stated)) {
      const std::string bytes = file_.read(at, kFrameHead);
      is_whole = bytes.size() == kFrameHead;
      if (!is_whole) break;
      ByteReader in(bytes, file_.path());
      const auto time_us = static_cast<std::int64_t>(in.number<std::uint64_t>("time of a frame"));
      Place place{at + kFrameHead, in.number<std::uint32_t>("size of depth"),
                  in.number<std::uint32_t>("size of colour")};
      const std::uint64_t end = place.at + place.depth_bytes + place.colour_bytes;
      is_whole = place.depth_bytes > 0 && end <= file_.size();
      if (!is_whole) break;
      places_.push_back(place);
      times_us.push_back(time_us);
      at = end;
    }
    if (places_.empty()) throw Error(file_.path() + ": no whole frame, expected a log of Kintinuous or ElasticFusion");
    if (!is_whole || (stated != 0 && places_.size() < stated)) {
      notes_.push_back(fmt::format("{}: cut short or damaged at byte {}; the {} whole frames before it are read",
                                   file_.path(), at, places_.size()));
    }
    frames_ = TimedFrames(times_us);
  }

  /// Finds out the size of the pictures by the first.
  Size find_size(const SourceOptions& options) const {
    const Place& first = places_.front();
    std::vector<Size> possible(std::begin(kUsualSizes), std::end(kUsualSizes));
    const CameraFacts facts = find_camera_facts(options, {});
    if (facts.width && facts.height) possible.insert(possible.begin(), {*facts.width, *facts.height});
    if (first.colour_bytes > 0) {
      const std::string bytes = colour_bytes(first);
      if (bytes.starts_with(kJpegMagic)) {
        const ColourImage colour = decode_colour(bytes, file_.path());
        possible.insert(possible.begin(), {colour.width(), colour.height()});
      }
    }
    const auto fits = [](std::size_t bytes) {
      return [bytes](const Size& size) { return bytes == size.pixels() * kDepthBytes; };
    };
    std::size_t bytes = first.depth_bytes;
    auto found = std::ranges::find_if(possible, fits(bytes));
    if (found == possible.end()) {
      constexpr std::size_t kMost = static_cast<std::size_t>(kMaxPixels) * kDepthBytes;
      bytes = decompress_zlib(file_.read(first.at, first.depth_bytes), kMost, file_.path()).size();
      found = std::ranges::find_if(possible, fits(bytes));
    }
    if (found == possible.end()) {
      throw Error(
          fmt::format("{}: depth of {} bytes, expected those of 640x480 pixels or another usual size, or that of "
                      "--camera",
                      file_.path(), bytes));
    }
    return *found;
  }

  std::string depth_bytes(const Place& place, const std::string& name) const {
    std::string bytes = file_.read(place.at, place.depth_bytes);
    const std::size_t expected = size_.pixels() * kDepthBytes;
    return bytes.size() == expected ? bytes : decompress_zlib(bytes, expected, name);
  }

  std::string colour_bytes(const Place& place) const {
    return file_.read(place.at + place.depth_bytes, place.colour_bytes);
  }

  DepthImage depth_of(const std::string& bytes, const std::string& name) const {
    if (bytes.size() != size_.pixels() * kDepthBytes) {
      throw Error(fmt::format("{}: depth of {} bytes, expected {} of {}x{} pixels", name, bytes.size(),
                              size_.pixels() * kDepthBytes, size_.width, size_.height));
    }
    Image<std::uint16_t> stored(size_.width, size_.height);
    ByteReader in(bytes, name);
    for (std::uint16_t& value : stored) value = in.number<std::uint16_t>("depth");
    return to_millimetres(stored, units_per_m_);
  }

  ColourImage colour_of(const std::string& bytes, const std::string& name) const {
    ColourImage colour;
    if (bytes.size() == size_.pixels() * sizeof(Rgb)) {
      colour = ColourImage(size_.width, size_.height);
      std::memcpy(static_cast<void*>(colour.data()), bytes.data(), bytes.size());
      return colour;
    }
    colour = decode_colour(bytes, name);
    if (colour.width() != size_.width || colour.height() != size_.height) {
      throw Error(fmt::format("{}: colour of {}x{} pixels, expected {}x{} as depth", name, colour.width(),
                              colour.height(), size_.width, size_.height));
    }
    return colour;
  }

  DataFile file_;
  std::vector<Place> places_;
  Size size_;  ///< of all pictures
  float units_per_m_ = 1000.F;
};

}  // namespace

std::unique_ptr<FrameSource> open_klg(const std::string& path, const SourceOptions& options) {
  return std::make_unique<KlgSource>(path, options);
}

}  // namespace vesalius
