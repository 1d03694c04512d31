#include "io/sources/camera_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "io/files/data_file.h"
#include "io/files/depth_picture.h"
#include "io/files/plain_text.h"
#include "io/sources/fact_tree.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxCameraFileBytes = 1 << 20;
constexpr std::size_t kMostOfFrames = 8;  // files in a folder for calibrations; of more, each is of a frame
constexpr int kRankByContents = 5;
[[noreturn]] void fail_at(const std::string& key, const std::string& expected) {
  throw UsageError(fmt::format("options: \"{}\": expected {}", key, expected));
}

float checked_focal(float value, const std::string& key) {
  if (!(value > 0.F && value < 1e6F)) fail_at(key, "a positive number of pixels");
  return value;
}

float checked_centre(float value, const std::string& key) {
  if (!(std::abs(value) < 1e6F)) fail_at(key, "a number of pixels");
  return value;
}

CameraFacts read_camera_file(const std::string& path) {
  if (path.ends_with(".npy")) {  // numpy.save of a matrix
    const DepthPicture matrix = read_depth(path);
    return parse_camera(fmt::format("{}", fmt::join(matrix.real, " ")), path);
  }
  return parse_camera(read_file(path, kMaxCameraFileBytes), path);
}

/// Returns the facts that the caller gave. A wrong value there is a UsageError.
CameraFacts facts_given(const SourceOptions& options) {
  CameraFacts facts;
  if (options.fx) facts.fx = checked_focal(*options.fx, "fx");
  if (options.fy) facts.fy = checked_focal(*options.fy, "fy");
  if (options.cx) facts.cx = checked_centre(*options.cx, "cx");
  if (options.cy) facts.cy = checked_centre(*options.cy, "cy");
  facts.depth_scale = options.depth_scale;
  if (facts.depth_scale && !(*facts.depth_scale >= 1.F && *facts.depth_scale <= 1e6F)) {
    fail_at("depth_scale", "stored units per metre, 1 to 1000000");
  }
  facts.depth_bits = options.depth_bits;
  return facts;
}

/// Returns how likely a file is a calibration of the pictures beside it, 0 surely; nothing for one that is none. Those
/// of depth come before those of colour, and before files of which only what is in them tells.
std::optional<int> rank_of_file(const fs::path& path, bool in_folder_for_them) {
  constexpr std::array<std::string_view, 13> kKinds{"json", "yaml", "yml",    "xml", "txt", "toml", "ini",
                                                    "csv",  "conf", "pincam", "npy", "npz", "mat"};
  const std::string stem = plain_name(path.stem().string()), extension = plain_name(path.extension().string());
  const auto has = [&](std::string_view word) { return stem.find(word) != stem.npos; };
  const bool list = extension == "txt" && (stem == "depth" || stem == "rgb" || stem == "color");
  const bool is_array = extension == "npy" || extension == "npz" || extension == "mat";
  const bool depths = is_array && stem != "k" && !has("trinsic") && !has("cam") && !has("calib");
  if (std::ranges::find(kKinds, extension) == kKinds.end() || list || depths) return std::nullopt;
  if (stem == "meta") return 0;
  if (stem == "camerainfo") return 1;
  const CameraRole role = role_in(stem);
  constexpr std::array<std::string_view, 8> kWords{"cam",  "trinsic", "calib",     "info",
                                                   "meta", "stereo",  "transform", "scene0"};
  const bool named = in_folder_for_them || stem == "k" || stem == "ost" || role != CameraRole::unsaid ||
                     std::ranges::any_of(kWords, has);
  if (named) return has("ir") || role == CameraRole::depth ? 2 : role == CameraRole::colour ? 4 : 3;
  const bool of_frame = extension == "json" && stem.starts_with("frame");
  const bool settings = extension == "yaml" || extension == "yml" || extension == "ini" || extension == "conf";
  return of_frame || settings ? std::optional(kRankByContents) : std::nullopt;
}

/// Returns the files of a folder that may be of its camera, the likeliest first. Of those of single frames, or of which
/// only what is in them tells, there are a few.
std::vector<fs::path> camera_files(const std::string& folder, bool is_for_them) {
  constexpr std::ptrdiff_t kMostByContents = 5;
  std::vector<std::pair<int, fs::path>> ranked;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    std::error_code ignored;
    const auto rank = rank_of_file(it->path(), is_for_them);
    if (rank && it->file_size(ignored) <= kMaxCameraFileBytes) ranked.emplace_back(*rank, it->path());
  }
  std::ranges::sort(ranked);
  const auto few = std::ranges::find(ranked, kRankByContents, &std::pair<int, fs::path>::first);
  ranked.erase(few + std::min(kMostByContents, ranked.end() - few), ranked.end());
  if (is_for_them && ranked.size() > kMostOfFrames) ranked.resize(1);
  std::vector<fs::path> files;
  files.reserve(ranked.size());
  for (auto& [rank, path] : ranked) files.push_back(std::move(path));
  return files;
}

/// Returns the folders in a folder that are for calibrations by their names, as those of ScanNet and Matterport have.
std::vector<fs::path> folders_for_cameras(const std::string& folder) {
  std::vector<fs::path> folders;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string name = plain_name(it->path().filename().string());
    const auto has = [&](std::string_view word) { return name.find(word) != name.npos; };
    std::error_code ignored;
    const bool named = has("intrinsic") || has("calib") || name == "cameras" || name == "camera" || name == "cam";
    if (named && it->is_directory(ignored)) folders.push_back(it->path());
  }
  std::ranges::sort(folders);
  return folders;
}

/// A file called meta or camera_info must be readable; others may be something else.
CameraFacts facts_in_folder(const std::string& folder) {
  CameraFacts facts;
  std::string broken;
  const auto read = [&](const fs::path& path) {
    const std::string stem = plain_name(path.stem().string());
    const bool by_contents = rank_of_file(path, false).value_or(0) == kRankByContents;
    if (by_contents && facts.has_focal()) return;
    try {
      CameraFacts found = read_camera_file(path.string());
      if (by_contents) found.lacks.clear();
      facts.fill_from(found);
    } catch (const Error& e) {
      if (stem == "meta" || stem == "camerainfo") throw;
      if (broken.empty() && !by_contents) broken = e.what();
    }
  };
  std::ranges::for_each(camera_files(folder, false), read);
  if (!facts.has_focal()) {
    for (const fs::path& inner : folders_for_cameras(folder)) {
      std::ranges::for_each(camera_files(inner.string(), true), read);
      if (facts.has_focal()) break;
    }
  }
  if (!facts.has_focal() && facts.sensor.empty() && !broken.empty()) throw Error(broken);
  return facts;
}

/// Focal lengths, from makers or common calibrations, for pictures of one size. Those for other sizes follow from them.
struct SensorFocal {
  std::vector<const char*> names;  ///< lower case; the sensor's name contains one of them
  int width, height;
  float own;         ///< focal length in pixels of depth on its own grid
  float registered;  ///< the same on the colour camera's grid, 0 = not known
  bool crops;        ///< other formats show the full height and crop the sides
};

const std::vector<SensorFocal>& known_sensors() {
  static const std::vector<SensorFocal> sensors = {
      {{"kinect v2", "kinect2", "kinect one"}, 512, 424, 365.F, 0.F, false},  // common calibrations
      {{"azure", "k4a", "femto"}, 640, 576, 504.F, 0.F, false},               // narrow mode
      // The numbers are a typical factory calibration of the D435's stereo pair, and its colour camera's 69x42 degrees.
      {{"realsense", "d415", "d435", "d455"}, 640, 480, 385.F, 615.F, true},
      {{"kinect", "xtion", "primesense", "openni", "carmine"}, 640, 480, 525.F, 525.F, false},  // OpenNI's default
  };
  return sensors;
}

/// Returns the sensor's usual focal length for pictures of this size, or 0 if it is not known.
float nominal_focal(const std::string& sensor, int width, int height, bool registered) {
  const std::string name = lower(sensor);
  for (const SensorFocal& known : known_sensors()) {
    const bool named = std::any_of(known.names.begin(), known.names.end(),
                                   [&](const char* n) { return name.find(n) != std::string::npos; });
    if (!named) continue;
    const bool same_format = std::int64_t{width} * known.height == std::int64_t{height} * known.width;
    if (!same_format && !known.crops) return 0.F;
    return (registered ? known.registered : known.own) * float(height) / float(known.height);
  }
  return 0.F;
}

template <class T>
void fill(std::optional<T>& mine, const std::optional<T>& theirs) {
  if (!mine) mine = theirs;
}

/// Returns whether rectified pictures are seen from the same place in the same direction, as those of one camera are.
bool keeps_direction(const Calibration& c) {
  const std::array<double, 9> same{1, 0, 0, 0, 1, 0, 0, 0, 1}, none{};
  return (c.rotation == same || c.rotation == none) && c.projection[3] == 0.0 && c.projection[7] == 0.0;
}

/// Takes the camera of the mode that an Azure Kinect's pictures are of, its depth's or, for depth on the grid of
/// colour, its colour's.
void take_k4a(CameraFacts& facts, int width, int height) {
  auto calibration = k4a_depth_calibration(*facts.k4a, width, height);
  constexpr int kLeastColourWidth = 1280;
  const bool of_colour = width >= kLeastColourWidth && (width * 3 == height * 4 || width * 9 == height * 16);
  if (!calibration && of_colour) calibration = k4a_colour_calibration(*facts.k4a, width, height);
  if (!calibration) {
    throw Error(fmt::format("{}: calibration of an Azure Kinect, but pictures of {}x{}, which is none of its modes",
                            facts.origin, width, height));
  }
  const CalibratedCamera camera = calibrated(*calibration, false);
  facts.fx = camera.pinhole.fx;
  fill(facts.fy, std::optional(camera.pinhole.fy));
  fill(facts.cx, std::optional(camera.pinhole.cx));
  fill(facts.cy, std::optional(camera.pinhole.cy));
  if (camera.lens.lens != Lens{}) facts.distorted = camera.lens;
}

/// Returns how far a camera's centre is from that of pictures, in their widths.
double off_centre(const CameraFacts& facts, int width, int height) {
  const double x = 2.0 * double(facts.cx.value_or(float(width) / 2.F)) / width - 1.0;
  const double y = 2.0 * double(facts.cy.value_or(float(height) / 2.F)) / height - 1.0;
  return std::hypot(x, y);
}

/// Makes one of the other cameras of a calibration the first.
void take_other(CameraFacts& facts, CameraFacts& other) {
  const CameraFacts taken = other;
  std::vector<CameraFacts> others = std::exchange(facts.others, {});
  std::vector<RigidFact> transforms = std::exchange(facts.transforms, {});
  others[std::size_t(&other - others.data())] = facts;
  facts.fx.reset();
  facts.fy = facts.cx = facts.cy = std::nullopt;
  facts.fill_from(taken);
  facts.others = std::move(others);
  facts.transforms = std::move(transforms);
}

/// Of cameras without sizes that no name tells apart, takes the one whose centre is nearest to that of the pictures.
void take_by_centre(CameraFacts& facts, int width, int height) {
  if (facts.width || !facts.fx || facts.role == CameraRole::depth || facts.role == CameraRole::colour) return;
  const auto off = [&](const CameraFacts& other) {
    const bool alike = !other.width && other.role != CameraRole::colour;
    return alike ? off_centre(other, width, height) : std::numeric_limits<double>::infinity();
  };
  const auto nearest = std::ranges::min_element(facts.others, {}, off);
  if (nearest != facts.others.end() && off(*nearest) < off_centre(facts, width, height)) take_other(facts, *nearest);
}

/// Returns by how much larger the pictures are that a calibration without a size is for, where its centre says that
/// they are others: those of a telephone's colour camera are 7.5 times as large as its depth.
std::optional<double> ratio_by_centre(const CameraFacts& facts, int width, int height) {
  constexpr double kSame = 1.4, kUnequal = 0.1, kSteps = 4.0, kMost = 16.0;
  if (facts.width || facts.height || !facts.fx || !facts.cx || !facts.cy) return std::nullopt;
  const double x = 2.0 * double(*facts.cx) / width, y = 2.0 * double(*facts.cy) / height, mean = (x + y) / 2.0;
  if (!(mean > 1.0 / kMost && mean < kMost) || std::abs(x - y) > kUnequal * mean) return std::nullopt;
  if (mean > kSame) return std::round(kSteps * mean) / kSteps;
  return mean < 1.0 / kSame ? std::optional(kSteps / std::round(kSteps / mean)) : std::nullopt;
}

/// Returns by how much larger pictures of the first two sides are, if that is a whole number or one over it, or at
/// least two by quarters, as the colour of telephones is larger than their depth: 3.75 and 7.5.
std::optional<double> ratio_by_size(std::int64_t from_width, std::int64_t from_height, int width, int height) {
  const bool same_shape = from_width * height == from_height * width;
  if (same_shape && from_width >= 2 * width && 4 * from_width % width == 0) return double(from_width) / width;
  return whole_ratio(from_width, from_height, width, height);
}

/// Makes a calibration of pictures of a size that of pictures whose pixels are `by` times as large.
void scale(CameraFacts& facts, double by, int width, int height) {
  const auto centre = [&](const std::optional<float>& at, int side) {
    return at.value_or(float(side * by - 1.0) / 2.F);
  };
  const Camera camera =
      scaled({0, 0, *facts.fx, facts.fy.value_or(*facts.fx), centre(facts.cx, width), centre(facts.cy, height)}, by,
             width, height);
  facts.fx = camera.fx;
  facts.fy = camera.fy;
  facts.cx = camera.cx;
  facts.cy = camera.cy;
  facts.calibrated_width = int(std::lround(by * width));
  facts.calibrated_height = int(std::lround(by * height));
  facts.width = width;
  facts.height = height;
  if (facts.distorted) facts.distorted->camera = scaled(facts.distorted->camera, by, width, height);
}

/// Makes a calibration that of pictures of a size: takes another camera of its file that has it, or scales it by a
/// whole number. Throws Error naming both sizes otherwise.
void fit_to_size(CameraFacts& facts, int width, int height, const std::string& place, std::vector<std::string>& notes) {
  if (facts.k4a && !facts.fx) take_k4a(facts, width, height);
  take_by_centre(facts, width, height);
  const auto fits = [&](const CameraFacts& f) {
    return f.width.value_or(width) == width && f.height.value_or(height) == height;
  };
  if (const auto by = ratio_by_centre(facts, width, height)) {
    scale(facts, *by, width, height);
    notes.push_back(
        fmt::format("{}: its centre is that of pictures {:.4g} times as large as the {}x{} of {}; it is "
                    "scaled to these",
                    facts.origin, *by, width, height, place));
  }
  if (fits(facts)) return;
  const auto other = std::ranges::find_if(facts.others, [&](const auto& f) { return f.width && f.height && fits(f); });
  if (other != facts.others.end()) {
    take_other(facts, *other);
    return;
  }
  const int calibrated_width = facts.width.value_or(width), calibrated_height = facts.height.value_or(height);
  const auto by = facts.width && facts.height && facts.fx
                      ? ratio_by_size(calibrated_width, calibrated_height, width, height)
                      : std::nullopt;
  if (!by) {
    throw Error(fmt::format("{}: camera of {}x{} pictures, but {} has {}x{}", facts.origin, calibrated_width,
                            calibrated_height, place, width, height));
  }
  scale(facts, *by, width, height);
  notes.push_back(fmt::format("{}: camera of {}x{} pictures, scaled to the {}x{} of {}", facts.origin, calibrated_width,
                              calibrated_height, width, height, place));
}

/// Throws Error naming `origin` where pictures of a camera would see all round, or nothing but a point; notes where
/// their centre is none.
void expect_possible(const Camera& camera, const std::string& origin, std::vector<std::string>& notes) {
  constexpr float kWidest = 0.1F, kNarrowest = 20.F, kCorner = 0.05F, kOutside = 0.5F;
  const auto width = float(camera.width), height = float(camera.height);
  for (const float focal : {camera.fx, camera.fy}) {
    if (focal >= kWidest * width && focal <= kNarrowest * width) continue;
    throw Error(
        fmt::format("{}: focal length {:.4g} for pictures of {}x{} pixels, expected {:.0f} to {:.0f} pixels, neither "
                    "millimetres nor shares of the width",
                    origin, focal, camera.width, camera.height, kWidest * width, kNarrowest * width));
  }
  const float x = camera.cx / width, y = camera.cy / height;
  const bool is_corner = std::abs(x) < kCorner && std::abs(y) < kCorner;
  const bool is_outside = std::max(std::abs(x - 0.5F), std::abs(y - 0.5F)) > 0.5F + kOutside;
  if (!is_corner && !is_outside) return;
  notes.push_back(fmt::format("{}: principal point {:.4g}, {:.4g} of pictures of {}x{} pixels, expected near {}, {}",
                              origin, camera.cx, camera.cy, camera.width, camera.height, camera.width / 2,
                              camera.height / 2));
}

}  // namespace

Camera scaled(const Camera& camera, double by, int width, int height) {
  const auto centre = [by](float at) { return float((double(at) + 0.5) / by - 0.5); };
  return {width, height, float(camera.fx / by), float(camera.fy / by), centre(camera.cx), centre(camera.cy)};
}

void CameraFacts::fill_from(const CameraFacts& other) {
  const bool needs_focal = !has_focal();
  // A lone fx means square pixels, so fy comes from the same place as fx or not at all.
  if (needs_focal) {
    fill(fx, other.fx);
    fill(fy, other.fy);
  }
  fill(cx, other.cx);
  fill(cy, other.cy);
  fill(depth_scale, other.depth_scale);
  fill(rate_hz, other.rate_hz);
  if (needs_focal && other.has_focal()) {
    width = other.width;
    height = other.height;
    distorted = other.distorted;
    odd_lens = other.odd_lens;
    origin = other.origin;
    others = other.others;
    k4a = other.k4a;
    role = other.role;
    from_librealsense = other.from_librealsense;
  } else if (other.has_focal()) {
    others.push_back(other);
    others.insert(others.end(), other.others.begin(), other.others.end());
  }
  transforms.insert(transforms.end(), other.transforms.begin(), other.transforms.end());
  if (lacks.empty()) lacks = other.lacks;
  if (sensor.empty()) sensor = other.sensor;
}

std::string serialise_meta(const Camera& camera, float depth_scale, std::optional<float> rate_hz) {
  // JSON should show the shortest text of the float, not that of the double nearest to it.
  const auto shortest = [](float value) { return std::stod(fmt::format("{}", value)); };
  nlohmann::ordered_json root;
  root["width"] = camera.width;
  root["height"] = camera.height;
  root["fx"] = shortest(camera.fx);
  root["fy"] = shortest(camera.fy);
  root["cx"] = shortest(camera.cx);
  root["cy"] = shortest(camera.cy);
  root["depth_scale"] = shortest(depth_scale);
  if (rate_hz) root["rate_hz"] = shortest(*rate_hz);
  return root.dump(1) + "\n";
}

CameraFacts find_camera_facts(const SourceOptions& options, const std::vector<std::string>& folders) {
  CameraFacts facts = facts_given(options);
  if (!options.camera_file.empty()) {
    facts.fill_from(read_camera_file(options.camera_file));
    const bool helps = facts.has_focal() || facts.depth_scale || facts.rate_hz || !facts.sensor.empty();
    if (!helps) throw Error(facts.lacks);
    return facts;
  }
  for (const std::string& folder : folders) {
    const CameraFacts found = facts_in_folder(folder);
    if (facts.lacks.empty()) facts.lacks = found.lacks;
    if (!found.has_focal() && found.sensor.empty() && !found.depth_scale && !found.rate_hz) continue;
    facts.fill_from(found);
    break;
  }
  return facts;
}

Camera resolve_camera(CameraFacts& facts, int width, int height, bool registered, const std::string& place,
                      std::vector<std::string>& notes) {
  fit_to_size(facts, width, height, place, notes);
  Camera camera{width, height, facts.fx.value_or(0.F), 0.F, 0.F, 0.F};
  if (!facts.fx) {
    camera.fx = nominal_focal(facts.sensor, width, height, registered);
    if (camera.fx == 0.F) {
      if (!facts.lacks.empty()) throw Error(facts.lacks);
      throw Error(
          place +
          ": no intrinsics: expected fx, fy, cx, cy in meta.json, a camera_info.yaml, or --fx, --fy, --cx, --cy" +
          (width == 640 && height == 480 ? "; of a Kinect v1 or Xtion usually --fx 525" : ""));
    }
    notes.push_back(fmt::format("{}: no focal length given; {:.4g} pixels assumed, usual for \"{}\"", place, camera.fx,
                                facts.sensor));
  }
  if (!facts.odd_lens.empty()) {
    notes.push_back(fmt::format("{}: lens distortion not removed, since its model \"{}\" is not known", facts.origin,
                                facts.odd_lens));
  }
  camera.fy = facts.fy.value_or(camera.fx);
  camera.cx = facts.cx.value_or(float(width - 1) / 2.F);
  camera.cy = facts.cy.value_or(float(height - 1) / 2.F);
  check(camera);
  expect_possible(camera, facts.origin.empty() ? place : facts.origin, notes);
  return camera;
}

CalibratedCamera calibrated(const Calibration& c, bool is_rectified) {
  const auto camera = [&](double fx, double fy, double cx, double cy) {
    return Camera{c.width, c.height, float(fx), float(fy), float(cx), float(cy)};
  };
  const Camera of_matrix = camera(c.matrix[0], c.matrix[4], c.matrix[2], c.matrix[5]);
  const std::optional<Lens> lens = make_lens(c.model, c.distortion);
  const bool distorted = lens != Lens{};
  const bool has_projection = c.projection[0] > 0.0 && c.projection[5] > 0.0;
  CalibratedCamera all{of_matrix, {of_matrix, {}}, {}};
  if (!distorted) return all;
  // What image_proc turns the pictures into.
  if (has_projection && (is_rectified || keeps_direction(c))) {
    all.pinhole = camera(c.projection[0], c.projection[5], c.projection[2], c.projection[6]);
  }
  if (is_rectified && has_projection) {
    all.lens.camera = all.pinhole;
  } else if (lens) {
    all.lens.lens = *lens;
  } else {
    all.pinhole = of_matrix;
    all.odd_model = c.model;
  }
  return all;
}

}  // namespace vesalius
