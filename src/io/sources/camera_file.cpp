#include "io/sources/camera_file.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "io/files/data_file.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr std::size_t kMaxCameraFileBytes = 1 << 20;
constexpr int kMaxSide = 1 << 16;
constexpr double kLowestRate_hz = 0.001;
constexpr double kHighestRate_hz = 10000.0;

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

[[noreturn]] void fail_at(const std::string& name, const std::string& key, const std::string& expected) {
  throw Error(fmt::format("{}: \"{}\": expected {}", name, key, expected));
}

float checked_focal(double value, const std::string& name, const std::string& key) {
  if (!(value > 0.0 && value < 1e6)) fail_at(name, key, "a positive number of pixels");
  return float(value);
}

float checked_centre(double value, const std::string& name, const std::string& key) {
  if (!(std::abs(value) < 1e6)) fail_at(name, key, "a number of pixels");
  return float(value);
}

float checked_scale(double value, const std::string& name, const std::string& key) {
  if (!(value >= 1.0 && value <= 1e6)) fail_at(name, key, "stored units per metre, 1 to 1000000");
  return float(value);
}

std::optional<double> number(const json& object, const std::string& key, const std::string& name) {
  const auto found = object.find(key);
  if (found == object.end()) return std::nullopt;
  if (!found->is_number()) fail_at(name, key, "a number");
  return found->get<double>();
}

std::optional<int> side_if_given(const json& object, const std::string& key, const std::string& name) {
  const std::optional<double> value = number(object, key, name);
  if (!value) return std::nullopt;
  if (!(*value >= 1.0 && *value <= kMaxSide) || std::floor(*value) != *value) fail_at(name, key, "a number of pixels");
  return int(*value);
}

/// Returns the units per metre that "mm", "mm (checked)" and so on name.
float scale_of_units(const json& units, const std::string& name) {
  const std::string text = units.is_string() ? units.get<std::string>() : "";
  const std::string word(text.begin(),
                         std::find_if(text.begin(), text.end(), [](unsigned char c) { return std::isalpha(c) == 0; }));
  if (word == "mm") return 1000.F;
  if (word == "cm") return 100.F;
  if (word == "m") return 1.F;
  fail_at(name, "units", R"("mm", "cm" or "m", or else "depth_scale" in units per metre)");
}

std::vector<double> numbers(const YAML::Node& node, std::size_t count, const std::string& name,
                            const std::string& key) {
  const YAML::Node list = node.IsMap() ? node["data"] : node;
  if (!list.IsDefined() || !list.IsSequence() || (count != 0 && list.size() != count)) {
    fail_at(name, key, count != 0 ? fmt::format("a list of {} numbers", count) : "a list of numbers");
  }
  std::vector<double> values;
  for (const YAML::Node& value : list) values.push_back(value.as<double>());
  return values;
}

/// Returns the value under the first of two keys that the file has; camera_calibration and rostopic spell them
/// differently.
YAML::Node either(const YAML::Node& root, const char* a, const char* b) {
  const YAML::Node first = root[a];
  return first.IsDefined() ? first : root[b];
}

/// Returns the camera behind its lens, nothing if that does not distort. `odd_model` receives a model that is not
/// known.
std::optional<LensCamera> distorted_camera(const YAML::Node& root, const std::vector<double>& matrix,
                                           const std::string& name, std::string& odd_model) {
  const YAML::Node d = either(root, "distortion_coefficients", "D");
  if (!d.IsDefined()) return std::nullopt;
  const std::vector<double> coefficients = numbers(d, 0, name, "distortion_coefficients");
  const YAML::Node model = root["distortion_model"];
  const std::string model_name = model.IsDefined() ? model.as<std::string>() : "";
  const std::optional<Lens> lens = make_lens(model_name, coefficients);
  if (!lens) odd_model = model_name.empty() ? "without a name" : model_name;
  if (!lens || *lens == Lens{}) return std::nullopt;
  return LensCamera{
      {0, 0, checked_focal(matrix[0], name, "camera_matrix"), checked_focal(matrix[4], name, "camera_matrix"),
       checked_centre(matrix[2], name, "camera_matrix"), checked_centre(matrix[5], name, "camera_matrix")},
      *lens};
}

CameraFacts camera_info_facts(const YAML::Node& root, const std::string& name) {
  CameraFacts facts;
  facts.origin = name;
  if (!root.IsMap()) throw Error(name + ": expected a map with camera_matrix (or K), image_width, image_height");
  const YAML::Node k = either(root, "camera_matrix", "K");
  const YAML::Node p = either(root, "projection_matrix", "P");
  if (!k.IsDefined()) fail_at(name, "camera_matrix", "3x3 numbers (or K)");
  std::vector<double> matrix = numbers(k, 9, name, "camera_matrix");
  facts.distorted = distorted_camera(root, matrix, name, facts.odd_lens);
  std::size_t stride = 3;
  if (facts.distorted && p.IsDefined()) {
    const std::vector<double> projection = numbers(p, 12, name, "projection_matrix");
    if (projection[0] != 0.0 && projection[5] != 0.0) {
      matrix = projection;
      stride = 4;
    }
  }
  facts.fx = checked_focal(matrix[0], name, "camera_matrix");
  facts.fy = checked_focal(matrix[stride + 1], name, "camera_matrix");
  facts.cx = checked_centre(matrix[2], name, "camera_matrix");
  facts.cy = checked_centre(matrix[stride + 2], name, "camera_matrix");
  const YAML::Node width = either(root, "image_width", "width");
  const YAML::Node height = either(root, "image_height", "height");
  if (width.IsDefined()) facts.width = width.as<int>();
  if (height.IsDefined()) facts.height = height.as<int>();
  if (facts.distorted) {
    facts.distorted->camera.width = facts.width.value_or(0);
    facts.distorted->camera.height = facts.height.value_or(0);
  }
  return facts;
}

CameraFacts read_camera_file(const std::string& path) {
  const std::string text = read_file(path, kMaxCameraFileBytes);
  const std::string extension = fs::path(path).extension().string();
  if (extension == ".yaml" || extension == ".yml") return parse_camera_info(text, path);
  return parse_meta(text, path);
}

/// Returns the facts that the caller gave. A wrong value there is a UsageError.
CameraFacts facts_given(const SourceOptions& options) try {
  CameraFacts facts;
  const std::string name = "options";
  if (options.fx) facts.fx = checked_focal(*options.fx, name, "fx");
  if (options.fy) facts.fy = checked_focal(*options.fy, name, "fy");
  if (options.cx) facts.cx = checked_centre(*options.cx, name, "cx");
  if (options.cy) facts.cy = checked_centre(*options.cy, name, "cy");
  if (options.depth_scale) facts.depth_scale = checked_scale(*options.depth_scale, name, "depth_scale");
  facts.depth_bits = options.depth_bits;
  return facts;
} catch (const Error& e) {
  throw UsageError(e.what());
}

CameraFacts facts_in_folder(const std::string& folder) {
  CameraFacts facts;
  for (const char* file : {"meta.json", "camera_info.yaml", "camera_info.yml"}) {
    const fs::path path = fs::path(folder) / file;
    std::error_code ignored;
    if (fs::exists(path, ignored)) facts.fill_from(read_camera_file(path.string()));
  }
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
  std::string lower = sensor;
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const SensorFocal& known : known_sensors()) {
    const bool named = std::any_of(known.names.begin(), known.names.end(),
                                   [&](const char* n) { return lower.find(n) != std::string::npos; });
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

}  // namespace

void CameraFacts::fill_from(const CameraFacts& other) {
  const bool needs_focal = !fx;
  fill(fx, other.fx);
  // A lone fx means square pixels, so fy comes from the same place as fx or not at all.
  if (needs_focal) fill(fy, other.fy);
  fill(cx, other.cx);
  fill(cy, other.cy);
  fill(depth_scale, other.depth_scale);
  fill(rate_hz, other.rate_hz);
  if (needs_focal && other.fx) {
    width = other.width;
    height = other.height;
    distorted = other.distorted;
    odd_lens = other.odd_lens;
    origin = other.origin;
  }
  if (sensor.empty()) sensor = other.sensor;
}

CameraFacts parse_meta(std::string_view text, const std::string& name) {
  json root;
  try {
    root = json::parse(text);
  } catch (const json::exception& e) {
    throw Error(name + ": not JSON: " + one_line(e.what()));
  }
  if (!root.is_object()) throw Error(name + ": expected a JSON object with fx, fy, cx, cy");
  CameraFacts facts;
  facts.origin = name;
  if (const auto v = number(root, "fx", name)) facts.fx = checked_focal(*v, name, "fx");
  if (const auto v = number(root, "fy", name)) facts.fy = checked_focal(*v, name, "fy");
  if (const auto v = number(root, "cx", name)) facts.cx = checked_centre(*v, name, "cx");
  if (const auto v = number(root, "cy", name)) facts.cy = checked_centre(*v, name, "cy");
  facts.width = side_if_given(root, "width", name);
  facts.height = side_if_given(root, "height", name);
  if (const auto v = number(root, "depth_scale", name)) {
    facts.depth_scale = checked_scale(*v, name, "depth_scale");
  } else if (const auto units = root.find("units"); units != root.end()) {
    facts.depth_scale = scale_of_units(*units, name);
  }
  if (const auto v = number(root, "rate_hz", name)) {
    if (!(*v >= kLowestRate_hz && *v <= kHighestRate_hz)) {
      fail_at(name, "rate_hz", fmt::format("frames a second, {} to {}", kLowestRate_hz, kHighestRate_hz));
    }
    facts.rate_hz = *v;
  }
  if (const auto sensor = root.find("sensor"); sensor != root.end() && sensor->is_string()) facts.sensor = *sensor;
  return facts;
}

CameraFacts parse_camera_info(std::string_view yaml, const std::string& name) {
  try {
    return camera_info_facts(YAML::Load(std::string(yaml)), name);
  } catch (const YAML::Exception& e) {
    throw Error(name + ": not the YAML of a camera_info: " + one_line(e.what()));
  }
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
    return facts;
  }
  for (const std::string& folder : folders) {
    const CameraFacts found = facts_in_folder(folder);
    if (found.origin.empty() && found.sensor.empty() && !found.depth_scale && !found.rate_hz) continue;
    facts.fill_from(found);
    break;
  }
  return facts;
}

Camera resolve_camera(const CameraFacts& facts, int width, int height, bool registered, const std::string& place,
                      std::vector<std::string>& notes) {
  if ((facts.width && *facts.width != width) || (facts.height && *facts.height != height)) {
    throw Error(fmt::format("{}: camera of {}x{} pictures, but {} has {}x{}", facts.origin, facts.width.value_or(width),
                            facts.height.value_or(height), place, width, height));
  }
  Camera camera{width, height, facts.fx.value_or(0.F), 0.F, 0.F, 0.F};
  if (!facts.fx) {
    camera.fx = nominal_focal(facts.sensor, width, height, registered);
    if (camera.fx == 0.F) {
      throw Error(
          place +
          ": no intrinsics: expected fx, fy, cx, cy in meta.json, a camera_info.yaml, or --fx, --fy, --cx, --cy");
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
