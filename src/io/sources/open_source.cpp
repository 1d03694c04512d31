#include "vesalius/open_source.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "io/files/data_file.h"
#include "io/files/depth_picture.h"
#include "io/files/image_bytes.h"
#include "io/files/known_kind.h"
#include "io/lens/lens.h"
#include "io/recordings/open_recording.h"
#include "io/sensors/reconnecting_source.h"
#include "io/sensors/sensor_drivers.h"
#include "io/sources/camera_file.h"
#include "io/sources/depth_check.h"
#include "io/sources/folder_source.h"
#include "io/sources/frames_inside.h"
#include "io/sources/list_source.h"
#include "io/sources/pcd.h"
#include "io/sources/recording_files.h"
#include "io/sources/recording_source.h"
#include "io/sources/source_around.h"
#include "io/sources/source_items.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

/// One kind of files. Cameras have a table of their own (sensor_drivers).
struct Scheme {
  std::string_view name;
  const char* what;  ///< what `open` expects
  std::unique_ptr<FrameSource> (*open)(const std::string& rest, const SourceOptions& options);
};

/// Returns what cameras a name that is no file may have meant; nothing where it is surely a path.
std::string cameras_meant(const std::string& name) {
  if (name.empty() || (name.find('/') != name.npos && !name.starts_with("/dev/"))) return {};
  std::vector<std::string> schemes;
  for (const SensorDriver& driver : sensor_drivers()) schemes.push_back(fmt::format("{}:", driver.scheme));
  return fmt::format(", or a camera ({}; vesalius cameras lists those that are plugged in)", fmt::join(schemes, ", "));
}

/// Returns whether `path` is a folder rather than a file. Throws Error if it does not exist.
bool is_folder(const std::string& path, const char* expected) {
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) {
    const std::string why = error ? error.message() : "no such file or folder";
    const std::string_view name = std::string_view(path).substr(0, path.find_last_not_of(':') + 1);
    throw Error(fmt::format("{}: {}, expected {}{}", name, why, expected, cameras_meant(path)));
  }
  return fs::is_directory(status);
}

constexpr const char* kFolder = "a folder with depth/*.png or depth PNG files";
constexpr const char* kTum = "a folder with depth.txt (TUM RGB-D)";
constexpr const char* kPcd = "an organised PCD file or a folder of them";
constexpr const char* kPng = "a depth PNG or a folder of them";
constexpr const char* kRecording = "an MCAP file, a ROS bag, a folder of these or an .mkv";
constexpr const char* kAnything = "a folder, a depth PNG, a PCD file or a recording";

void refuse_colour_file(const std::string& path, const SourceOptions& options) {
  if (!options.colour_file.empty()) throw UsageError(path + ": a colour file goes with a single depth PNG only");
}

/// Throws unless `path` is a folder.
void expect_folder(const std::string& path, const SourceOptions& options, const char* expected) {
  const bool folder = is_folder(path, expected);
  refuse_colour_file(path, options);
  if (!folder) throw Error(path + ": a file, expected a folder");
}

std::unique_ptr<FrameSource> open_folder(const std::string& path, const SourceOptions& options) {
  expect_folder(path, options, kFolder);
  return open_list(list_folder(path, options));
}

std::unique_ptr<FrameSource> open_tum(const std::string& path, const SourceOptions& options) {
  expect_folder(path, options, kTum);
  return open_list(list_tum(path, options));
}

std::unique_ptr<FrameSource> open_clouds(const std::string& path, const SourceOptions& options) {
  is_folder(path, kPcd);
  refuse_colour_file(path, options);
  return open_pcd(path, options);
}

std::unique_ptr<FrameSource> open_png(const std::string& path, const SourceOptions& options) {
  if (is_folder(path, kPng)) return open_folder(path, options);
  return open_list(list_single_picture(path, options));
}

std::unique_ptr<FrameSource> open_recording_file(const std::string& path, const SourceOptions& options) {
  is_folder(path, kRecording);
  refuse_colour_file(path, options);
  return open_recorded(path, options);
}

/// The frames of a source from a time on.
class Started final : public SourceAround {
 public:
  /// Throws UsageError unless `start_s` lies between the first and the last frame.
  Started(std::unique_ptr<FrameSource> around, double start_s, const std::string& uri)
      : SourceAround(std::move(around)) {
    constexpr double kRounding_s = 1e-3;  // of the length in the message
    const std::optional<TimeSpan> span = source().span();
    if (!span) throw UsageError(uri + ": a start goes with recordings and files only");
    const double length_s = span->last_s - span->first_s;
    if (!(start_s >= 0.0 && start_s <= length_s + kRounding_s)) {
      throw UsageError(
          fmt::format("{}: a start of {} s, expected 0 to {:.3f} s, where its last frame is", uri, start_s, length_s));
    }
    source().seek(std::min(span->first_s + start_s, span->last_s));
  }
  int size() const override { return -1; }
};

/// A camera whose lens the user knows better than its driver.
class Calibrated final : public SourceAround {
 public:
  Calibrated(std::unique_ptr<FrameSource> source, CameraFacts facts, std::string place)
      : SourceAround(std::move(source)), facts_(std::move(facts)), place_(std::move(place)) {}
  std::optional<Frame> next() override {
    std::optional<Frame> frame = source().next();
    if (!frame) return frame;
    std::vector<std::string> ignored;
    frame->camera = resolve_camera(facts_, frame->depth.width(), frame->depth.height(), true, place_, ignored);
    if (!facts_.distorted) return frame;
    if (!rectification_) rectification_ = make_rectification(facts_.distorted, frame->camera);
    frame->depth = rectification_->depth(frame->depth);
    if (!frame->colour.empty()) frame->colour = rectification_->colour(frame->colour);
    return frame;
  }

 private:
  CameraFacts facts_;
  std::string place_;
  std::optional<Rectification> rectification_;
};

std::unique_ptr<FrameSource> open_camera(const SensorDriver& driver, const std::string& id,
                                         const SourceOptions& options) {
  const std::string place = fmt::format("{}:{}", driver.scheme, id);
  refuse_colour_file(place, options);
  if (options.start_s) throw UsageError(place + ": a camera begins now; a start goes with recordings and files only");
  if (options.depth_scale || options.depth_bits != DepthBits::plain) {
    throw UsageError(place + ": a camera says itself how depth is stored");
  }
  const CameraFacts facts = find_camera_facts(options, {});
  const auto open = [&driver, id] { return open_sensor(driver, id); };
  std::unique_ptr<FrameSource> source =
      options.reconnect ? keep_open(open, {source_of(driver.scheme, id), options.say}) : open();
  if (!facts.has_focal()) return source;
  return std::make_unique<Calibrated>(std::move(source), facts, place);
}

constexpr std::array<Scheme, 5> kSchemes{{{"folder", kFolder, open_folder},
                                          {"tum", kTum, open_tum},
                                          {"pcd", kPcd, open_clouds},
                                          {"png", kPng, open_png},
                                          {"recording", kRecording, open_recording_file}}};

/// Returns the row of `table` whose scheme "pcd:cloud.pcd" begins with, or null for a plain path.
template <class Table, class Name>
const auto* row_of(const Table& table, const std::string& uri, Name name) {
  const auto found = std::ranges::find(table, std::string_view(uri).substr(0, uri.find(':')), name);
  return found == table.end() || std::invoke(name, *found).size() == uri.size() ? nullptr : &*found;
}

const Scheme* scheme_of(const std::string& uri) { return row_of(kSchemes, uri, &Scheme::name); }
const SensorDriver* camera_of(const std::string& uri) { return row_of(sensor_drivers(), uri, &SensorDriver::scheme); }

std::string_view scheme_of_file(const std::string& path) {
  const std::string extension = lower_extension(path);
  if (std::ranges::find(depth_extensions(), extension) != depth_extensions().end()) return "png";
  if (std::ranges::find(unread_depth_extensions(), extension) != unread_depth_extensions().end()) {
    throw Error(path + ": " + unread_advice(extension));
  }
  if (extension == ".pcd") return "pcd";
  if (has_recording_name(path)) return "recording";
  const std::string first = DataFile(path).read(0, kKindBytes);
  if (is_recording(first)) return "recording";
  if (is_png(first)) return "png";
  if (first.starts_with("# .PCD")) return "pcd";
  throw Error(fmt::format("{}: {}, expected {}", path, kind_or(first, "unknown kind of file"), kAnything));
}

std::string_view scheme_of_folder(const std::string& path) {
  std::error_code ignored;
  if (is_tum_folder(path)) return "tum";
  if (fs::exists(fs::path(path) / "metadata.yaml", ignored)) return "recording";
  if (has_depth_folder(path)) return "folder";
  const std::vector<fs::path> pictures = list_files(path, depth_extensions());
  const bool png = !pictures.empty();
  const bool pcd = !list_files(path, {".pcd"}).empty();
  if (png && pcd) throw Error(path + ": PNG and PCD files in one folder, expected folder: or pcd: before the path");
  // A picture of the screen beside a recording is no depth.
  const auto is_depth = [](const fs::path& picture) { return may_be_depth(picture.string()); };
  if (png && std::ranges::none_of(pictures, is_depth) && !list_recording(path).empty()) return "recording";
  if (png) return "folder";
  if (pcd) return "pcd";
  if (!list_recording(path).empty()) return "recording";
  throw Error(
      with_items(path + ": no frames, expected depth/*.png, depth.txt, *.png, *.pcd or recordings" + frames_below(path),
                 items_of(path)));
}

std::unique_ptr<FrameSource> open_files(const std::string& uri, const SourceOptions& options) {
  if (const Scheme* scheme = scheme_of(uri)) return scheme->open(uri.substr(scheme->name.size() + 1), options);
  const std::string_view name = is_folder(uri, kAnything) ? scheme_of_folder(uri) : scheme_of_file(uri);
  return std::ranges::find(kSchemes, name, &Scheme::name)->open(uri, options);
}

std::unique_ptr<FrameSource> open_started(const std::string& uri, const SourceOptions& options) {
  if (options.reconnect) throw UsageError(uri + ": only a camera can be waited for (--reconnect)");
  std::unique_ptr<FrameSource> source = open_files(uri, options);
  if (!options.start_s) return source;
  return std::make_unique<Started>(std::move(source), *options.start_s, uri);
}

}  // namespace

std::unique_ptr<FrameSource> open_source(const std::string& uri, const SourceOptions& options) {
  const SensorDriver* driver = camera_of(uri);
  std::unique_ptr<FrameSource> source =
      driver != nullptr ? open_camera(*driver, uri.substr(driver->scheme.size() + 1), options)
                        : with_depth_checked(open_started(uri, options), uri, options,
                                             [&](const SourceOptions& other) { return open_started(uri, other); });
  if (!options.turn) return source;
  return std::make_unique<TurnedSource>(std::move(source), *options.turn);
}

bool is_camera(const std::string& uri) { return camera_of(uri) != nullptr; }

std::string path_of_source(const std::string& uri) {
  if (const SensorDriver* driver = camera_of(uri)) return uri.substr(driver->scheme.size() + 1);
  const Scheme* scheme = scheme_of(uri);
  return scheme == nullptr ? uri : uri.substr(scheme->name.size() + 1);
}

Frame make_frame(const Camera& camera, const std::uint16_t* depth_mm, std::size_t depth_stride, const std::uint8_t* rgb,
                 std::size_t rgb_stride) {
  check(camera);
  if (std::int64_t{camera.width} * camera.height > kMaxPixels) throw Error("frame buffers: more pixels than supported");
  if (depth_mm == nullptr) throw Error("frame buffers: no depth, expected a pointer to its first value");
  const std::size_t width = camera.width;
  const std::size_t depth_bytes = width * sizeof(std::uint16_t);
  const std::size_t rgb_bytes = width * 3;
  if (depth_stride == 0) depth_stride = depth_bytes;
  if (rgb_stride == 0) rgb_stride = rgb_bytes;
  if (depth_stride < depth_bytes || rgb_stride < rgb_bytes) {
    throw Error(fmt::format("frame buffers: strides {} (depth) and {} (colour) bytes, expected at least {} and {}",
                            depth_stride, rgb_stride, depth_bytes, rgb_bytes));
  }
  Frame frame;
  frame.camera = camera;
  frame.depth = DepthImage(camera.width, camera.height);
  if (rgb != nullptr) frame.colour = ColourImage(camera.width, camera.height);
  static_assert(sizeof(Rgb) == 3);
  copy_rows(depth_mm, depth_stride, frame.depth);
  if (rgb != nullptr) copy_rows(rgb, rgb_stride, frame.colour);
  return frame;
}

}  // namespace vesalius
