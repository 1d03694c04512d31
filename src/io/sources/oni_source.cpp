#include "io/sources/oni_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <utility>
#include <vector>

#include "io/files/byte_stream.h"
#include "io/files/image_bytes.h"
#include "io/files/image_file.h"
#include "io/recordings/oni_depth.h"
#include "io/recordings/oni_recording.h"
#include "io/sources/camera_file.h"
#include "io/sources/list_source.h"

namespace vesalius {
namespace {

constexpr std::int64_t kMostApart_us = 50'000;

/// Formats of pixels as OpenNI 2 numbers them; OpenNI 1 has other numbers for those of colour.
enum class Pixels : std::uint64_t {
  depth_1_mm = 100,
  depth_100_um = 101,
  shifts_9_2 = 102,
  shifts_9_3 = 103,
  rgb = 200,
  jpeg = 204
};

/// Returns how the pixels of a stream are laid out; `usual` where it does not say.
Pixels pixels_of(const OniStream& stream, Pixels usual) {
  if (const auto format = stream.integer("oniPixelFormat")) return static_cast<Pixels>(*format);
  if (stream.kind == OniKind::depth) return usual;
  constexpr std::uint64_t kRgb = 1, kJpeg = 5;
  const auto old = stream.integer("xnPixelFormat");
  if (!old || *old == kRgb) return usual;
  return *old == kJpeg ? Pixels::jpeg : static_cast<Pixels>(*old);
}

/// The part of the camera's grid that pictures show.
struct Grid {
  int full_width = 0, full_height = 0;
  int left = 0, top = 0, width = 0, height = 0;
};

/// Throws Error naming `place` if the stream does not say its size.
Grid grid_of(const OniStream& stream, const std::string& place) {
  Grid grid;
  const auto mode = stream.properties.find("xnMapOutputMode");
  if (mode == stream.properties.end()) throw Error(fmt::format("{}: {} has no size", place, stream.name));
  ByteReader in(mode->second, place);
  const auto width = in.number<std::uint32_t>("width"), height = in.number<std::uint32_t>("height");
  const std::uint64_t pixels = std::uint64_t{width} * height;
  if (pixels == 0 || pixels > static_cast<std::uint64_t>(kMaxPixels)) {
    throw Error(
        fmt::format("{}: {} of {}x{} pixels, expected at most {}", place, stream.name, width, height, kMaxPixels));
  }
  grid.full_width = grid.width = int(width);
  grid.full_height = grid.height = int(height);
  const auto cropping = stream.properties.find("xnCropping");
  if (cropping == stream.properties.end()) return grid;
  ByteReader part(cropping->second, place);
  if (part.number<std::uint32_t>("cropping") == 0) return grid;
  grid.left = part.number<std::uint16_t>("cropping");
  grid.top = part.number<std::uint16_t>("cropping");
  grid.width = part.number<std::uint16_t>("cropping");
  grid.height = part.number<std::uint16_t>("cropping");
  if (grid.width == 0 || grid.height == 0 || grid.left + grid.width > grid.full_width ||
      grid.top + grid.height > grid.full_height) {
    throw Error(fmt::format("{}: {} cropped to {}x{} at {}, {}, expected within {}x{}", place, stream.name, grid.width,
                            grid.height, grid.left, grid.top, grid.full_width, grid.full_height));
  }
  return grid;
}

/// Returns the table of depth in millimetres by shift, empty if there is none.
std::vector<std::uint16_t> table_of_shifts(const OniStream& stream, const std::string& place) {
  std::vector<std::uint16_t> table;
  const auto found = stream.properties.find("S2D");
  if (found == stream.properties.end()) return table;
  ByteReader in(found->second, place);
  while (in.left() >= sizeof(std::uint16_t)) table.push_back(in.number<std::uint16_t>("depth of a shift"));
  return table;
}

/// Returns fx and fy in pixels of the whole grid; nothing where the stream does not say.
std::vector<double> focal_of(const OniStream& stream, const Grid& grid) {
  std::vector<double> focal;
  if (const auto view = stream.reals("xnFOV", 2); !view.empty()) {
    focal = {grid.full_width / (2.0 * std::tan(view[0] / 2.0)), grid.full_height / (2.0 * std::tan(view[1] / 2.0))};
  } else if (const auto plane = stream.reals("xnRealWorldTranslationData", 3); !plane.empty()) {
    focal = {plane[0] / (plane[1] * plane[2]), plane[0] / (plane[1] * plane[2])};
  }
  const bool usable = std::ranges::all_of(focal, [](double f) { return std::isfinite(f) && f >= 1.0 && f < 1e6; });
  return usable ? focal : std::vector<double>();
}

template <class T>
void turn_back(Image<T>& image) {
  for (int v = 0; v < image.height(); ++v) std::reverse(image.row(v), image.row(v) + image.width());
}

std::string names_of(const std::vector<const OniStream*>& streams) {
  std::string text;
  for (const OniStream* stream : streams) text += (text.empty() ? "" : ", ") + stream->name;
  return text;
}

class OniSource final : public FrameSource {
 public:
  OniSource(const std::string& path, const SourceOptions& options) : path_(path), recording_(DataFile(path)) {
    notes_ = recording_.notes();
    choose_depth(options);
    choose_colour(options);
    set_camera(options);
    name_frames();
  }

  std::optional<Frame> next() override {
    if (next_ == depth_->pictures.size()) return std::nullopt;
    const std::size_t index = next_++;
    const OniPicture& picture = depth_->pictures[index];
    const std::string place = fmt::format("{}: {}", path_, names_[index]);
    Frame frame;
    frame.name = names_[index];
    frame.time_s = times_s_[index];
    frame.camera = camera_;
    frame.depth = to_millimetres(depth_at(picture, place), units_per_m_);
    if (picture.mirrored) turn_back(frame.depth);
    if (colour_ != nullptr) frame.colour = colour_near(picture.time_us, place);
    return frame;
  }
  int size() const override { return int(times_s_.size()); }
  std::optional<TimeSpan> span() const override {
    return TimeSpan{times_s_.front(), std::max(times_s_.front(), times_s_.back())};
  }
  void seek(double time_s) override {
    const auto found = std::ranges::find_if(times_s_, [time_s](double one) { return !(one < time_s); });
    next_ = static_cast<std::size_t>(found - times_s_.begin());
  }
  std::vector<std::string> notes() const override { return notes_; }

 private:
  /// Names frames by their times; those of one time get different names.
  void name_frames() {
    constexpr double kMicroseconds = 1e6;
    for (const OniPicture& picture : depth_->pictures) {
      times_s_.push_back(double(picture.time_us) / kMicroseconds);
      std::string name = fmt::format("{:.6f}", times_s_.back());
      while (!names_.empty() && names_.back().starts_with(name)) name += "_again";
      names_.push_back(std::move(name));
    }
  }

  std::vector<const OniStream*> streams_of(OniKind kind) const {
    std::vector<const OniStream*> found;
    for (const OniStream& stream : recording_.streams()) {
      if (stream.kind == kind && !stream.pictures.empty()) found.push_back(&stream);
    }
    return found;
  }

  void choose_depth(const SourceOptions& options) {
    std::vector<const OniStream*> found = streams_of(OniKind::depth);
    if (found.empty()) throw Error(path_ + ": no depth, expected a stream of it with pictures");
    if (!options.depth_topic.empty()) {
      const auto named = std::ranges::find(found, options.depth_topic, &OniStream::name);
      if (named == found.end()) {
        throw UsageError(
            fmt::format("{}: no depth of stream {}, expected {}", path_, options.depth_topic, names_of(found)));
      }
      found = {*named};
    }
    depth_ = found.front();
    if (found.size() > 1) {
      notes_.push_back(fmt::format("{}: depth of {}; there is also {}", path_, depth_->name,
                                   names_of({found.begin() + 1, found.end()})));
    }
    grid_ = grid_of(*depth_, path_);
    if (depth_->codec != "16zT" && depth_->codec != "16zP" && depth_->codec != "NONE") {
      throw Error(fmt::format("{}: depth packed with \"{}\", expected 16zT, 16zP or NONE", path_, depth_->codec));
    }
    const Pixels pixels = pixels_of(*depth_, Pixels::depth_1_mm);
    if (pixels == Pixels::shifts_9_2 || pixels == Pixels::shifts_9_3) {
      shifts_ = table_of_shifts(*depth_, path_);
      if (shifts_.empty()) throw Error(path_ + ": depth as shifts, expected a property S2D with their table");
    } else if (pixels == Pixels::depth_100_um) {
      units_per_m_ = 10000.F;
    } else if (pixels != Pixels::depth_1_mm) {
      throw Error(
          fmt::format("{}: depth of format {}, expected 100 to 103", path_, static_cast<std::uint64_t>(pixels)));
    }
  }

  void choose_colour(const SourceOptions& options) {
    const std::vector<const OniStream*> found = streams_of(OniKind::colour);
    const bool is_named = !options.colour_topic.empty();
    const auto named = std::ranges::find(found, options.colour_topic, &OniStream::name);
    if (is_named && named == found.end()) {
      throw UsageError(fmt::format("{}: no colour of stream {}", path_, options.colour_topic));
    }
    if (found.empty()) return;
    const OniStream* colour = is_named ? *named : found.front();
    const std::string reason = why_not(*colour, is_named);
    if (reason.empty()) {
      colour_ = colour;
    } else if (is_named) {
      throw Error(fmt::format("{}: {}", path_, reason));
    } else {
      notes_.push_back(fmt::format("{}: no colour, since {}", path_, reason));
    }
  }

  /// Returns why a colour stream is of no use, nothing if it is.
  std::string why_not(const OniStream& colour, bool is_registered) const {
    if (!is_registered && depth_->integer("Registration").value_or(0) == 0) {
      return fmt::format("the file does not say that depth is registered to it; --colour-topic {} takes it so",
                         colour.name);
    }
    const Grid grid = grid_of(colour, path_);
    if (grid.width != grid_.width || grid.height != grid_.height || grid.left != grid_.left || grid.top != grid_.top) {
      return fmt::format("{} has {}x{} pixels, depth {}x{}", colour.name, grid.width, grid.height, grid_.width,
                         grid_.height);
    }
    const Pixels pixels = pixels_of(colour, Pixels::rgb);
    const bool known =
        colour.codec == "JPEG" || (colour.codec == "NONE" && (pixels == Pixels::rgb || pixels == Pixels::jpeg));
    if (!known) {
      return fmt::format("{} is packed with \"{}\" in format {}, expected JPEG or pixels of RGB", colour.name,
                         colour.codec, static_cast<std::uint64_t>(pixels));
    }
    return {};
  }

  /// Registered depth lies on the grid of colour.
  void set_camera(const SourceOptions& options) {
    CameraFacts facts = find_camera_facts(options, {});
    if (facts.depth_scale) units_per_m_ = *facts.depth_scale;
    std::vector<double> focal;
    if (colour_ != nullptr) focal = focal_of(*colour_, grid_);
    if (focal.empty()) focal = focal_of(*depth_, grid_);
    if (!facts.fx && focal.empty()) {
      constexpr double kUsual = 525.0 / 640.0;  // of PrimeSense cameras
      focal.assign(2, kUsual * grid_.full_width);
      notes_.push_back(
          fmt::format("{}: no field of view given; a focal length of {:.4g} pixels assumed", path_, focal[0]));
    }
    if (!facts.fx) {
      CameraFacts own;
      own.fx = float(focal[0]);
      own.fy = float(focal[1]);
      own.cx = float(grid_.full_width - 1) / 2.F - float(grid_.left);
      own.cy = float(grid_.full_height - 1) / 2.F - float(grid_.top);
      if (depth_->pictures.front().mirrored) own.cx = float(grid_.width - 1) - *own.cx;
      facts.fill_from(own);
    }
    camera_ = resolve_camera(facts, grid_.width, grid_.height, colour_ != nullptr, path_, notes_);
  }

  Image<std::uint16_t> depth_at(const OniPicture& picture, const std::string& place) const {
    const std::string bytes = recording_.read(*depth_, picture);
    if (depth_->codec != "NONE") {
      const OniPacking packing = depth_->codec == "16zT" ? OniPacking::table_differences : OniPacking::differences;
      return by_table(unpack_oni(bytes, packing, grid_.width, grid_.height, place), place);
    }
    expect_size(bytes, pixels() * sizeof(std::uint16_t), place);
    Image<std::uint16_t> depth(grid_.width, grid_.height);
    ByteReader in(bytes, place);
    for (std::uint16_t& value : depth) value = in.number<std::uint16_t>("depth");
    return by_table(std::move(depth), place);
  }

  /// Turns shifts into millimetres, if it is those.
  Image<std::uint16_t> by_table(Image<std::uint16_t> depth, const std::string& place) const {
    if (shifts_.empty()) return depth;
    for (std::uint16_t& value : depth) {
      if (value >= shifts_.size()) {
        throw Error(fmt::format("{}: a shift of {}, expected less than {}", place, value, shifts_.size()));
      }
      value = shifts_[value];
    }
    return depth;
  }

  std::size_t pixels() const { return static_cast<std::size_t>(grid_.width) * static_cast<std::size_t>(grid_.height); }

  static void expect_size(const std::string& bytes, std::size_t expected, const std::string& place) {
    if (bytes.size() == expected) return;
    throw Error(fmt::format("{}: a picture of {} bytes, expected {}", place, bytes.size(), expected));
  }

  ColourImage colour_near(std::int64_t time_us, const std::string& place) const {
    const auto apart = [time_us](const OniPicture& picture) {
      return std::abs(double(picture.time_us) - double(time_us));
    };
    const OniPicture& nearest = *std::ranges::min_element(colour_->pictures, {}, apart);
    if (apart(nearest) > kMostApart_us) return {};
    const std::string bytes = recording_.read(*colour_, nearest);
    ColourImage colour;
    if (colour_->codec == "JPEG" || pixels_of(*colour_, Pixels::rgb) == Pixels::jpeg) {
      colour = decode_colour(bytes, place);
      if (colour.width() != grid_.width || colour.height() != grid_.height) {
        throw Error(fmt::format("{}: colour of {}x{} pixels, expected {}x{}", place, colour.width(), colour.height(),
                                grid_.width, grid_.height));
      }
    } else {
      expect_size(bytes, pixels() * sizeof(Rgb), place);
      colour = ColourImage(grid_.width, grid_.height);
      std::memcpy(static_cast<void*>(colour.data()), bytes.data(), bytes.size());
    }
    if (nearest.mirrored) turn_back(colour);
    return colour;
  }

  std::string path_;
  OniRecording recording_;
  const OniStream* depth_ = nullptr;
  const OniStream* colour_ = nullptr;  ///< null = none
  Grid grid_;
  std::vector<std::uint16_t> shifts_;  ///< millimetres by shift; empty = depth is stored
  float units_per_m_ = 1000.F;
  Camera camera_;
  std::vector<double> times_s_;
  std::vector<std::string> names_, notes_;
  std::size_t next_ = 0;
};

}  // namespace

bool is_oni(const std::string& path) { return DataFile(path).read(0, kOniMagic.size()) == kOniMagic; }

std::unique_ptr<FrameSource> open_oni(const std::string& path, const SourceOptions& options) {
  return std::make_unique<OniSource>(path, options);
}

}  // namespace vesalius
