#include "io/recordings/k4a_messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "io/files/byte_stream.h"
#include "vesalius/error.h"

namespace vesalius {
namespace {

using nlohmann::json;

constexpr int kSensorSide = 1024;

const json& member(const json& object, const char* key, const std::string& name) {
  const auto found = object.is_object() ? object.find(key) : object.end();
  if (!object.is_object() || found == object.end()) throw Error(fmt::format("{}: no \"{}\"", name, key));
  return *found;
}

std::vector<double> numbers(const json& object, const char* key, std::size_t count, const std::string& name) {
  const json& list = member(object, key, name);
  std::vector<double> values;
  if (list.is_array()) {
    for (const json& value : list) {
      if (value.is_number() && std::isfinite(value.get<double>())) values.push_back(value.get<double>());
    }
  }
  if (values.size() != count || list.size() != count) {
    throw Error(fmt::format("{}: \"{}\": expected a list of {} numbers", name, key, count));
  }
  return values;
}

int sensor_side(const json& object, const char* key, const std::string& name) {
  const json& value = member(object, key, name);
  constexpr double kMost = 1 << 16;
  if (!value.is_number() || !(value.get<double>() >= 1.0 && value.get<double>() <= kMost)) {
    throw Error(fmt::format("{}: \"{}\": expected a number of pixels", name, key));
  }
  return int(value.get<double>());
}

/// What takes points of the depth camera to a sensor.
Eigen::Isometry3d transform_of(const json& sensor, const std::string& name) {
  constexpr double kOff = 1e-2;
  const json& rt = member(sensor, "Rt", name);
  const std::vector<double> r = numbers(rt, "Rotation", 9, name), t = numbers(rt, "Translation", 3, name);
  const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> rotation(r.data());
  if (!rotation.isUnitary(kOff) || rotation.determinant() < 0.0) {
    throw Error(name + ": \"Rotation\": expected a rotation");
  }
  return Eigen::Translation3d(t[0], t[1], t[2]) * Eigen::Quaterniond(Eigen::Matrix3d(rotation)).normalized();
}

K4aCalibration::Sensor camera_of(const json& camera, const std::string& name) {
  constexpr std::size_t kParameters = 14;
  const json& intrinsics = member(camera, "Intrinsics", name);
  const json& model = member(intrinsics, "ModelType", name);
  if (model != "CALIBRATION_LensDistortionModelBrownConrady") {
    throw Error(name + ": \"ModelType\": expected CALIBRATION_LensDistortionModelBrownConrady");
  }
  // cx cy fx fy, k1 to k6, the centre of distortion, p2 p1.
  const std::vector<double> p = numbers(intrinsics, "ModelParameters", kParameters, name);
  if (!(p[2] > 0.0 && p[3] > 0.0)) throw Error(name + ": \"ModelParameters\": expected positive focal lengths");
  if (p[10] != 0.0 || p[11] != 0.0) throw Error(name + ": \"ModelParameters\": expected no centre of distortion");
  return {p[0],
          p[1],
          p[2],
          p[3],
          sensor_side(camera, "SensorWidth", name),
          sensor_side(camera, "SensorHeight", name),
          {p[4], p[5], p[13], p[12], p[6], p[7], p[8], p[9]},
          transform_of(camera, name)};
}

/// Returns the first of a list whose `key` is `value`; null if none is.
const json* first_with(const json& list, const char* key, const char* value) {
  if (!list.is_array()) return nullptr;
  const auto found =
      std::ranges::find_if(list, [&](const json& one) { return one.is_object() && one.value(key, json()) == value; });
  return found == list.end() ? nullptr : &*found;
}

/// Returns the calibration of pictures whose whole sensor would be `sensor_width` x `sensor_height` pixels, without
/// `left` and `top` of these.
Calibration of_pictures(const K4aCalibration::Sensor& sensor, double sensor_width, double sensor_height, double left,
                        double top, int width, int height) {
  const double fx = sensor.fx * sensor_width, fy = sensor.fy * sensor_height;
  const double cx = sensor.cx * sensor_width - left - 0.5, cy = sensor.cy * sensor_height - top - 0.5;
  Calibration calibration;
  calibration.width = width;
  calibration.height = height;
  calibration.model = "rational_polynomial";
  calibration.distortion.assign(sensor.distortion.begin(), sensor.distortion.end());
  calibration.matrix = {fx, 0, cx, 0, fy, cy, 0, 0, 1};
  calibration.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  calibration.projection = {fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0};
  return calibration;
}

}  // namespace

K4aCalibration parse_k4a_calibration(std::string_view text, const std::string& name) {
  // Some end in zeros, as strings of C do.
  text = text.substr(0, text.find('\0'));
  const json root = json::parse(text, nullptr, false);
  if (root.is_discarded()) throw Error(name + ": not JSON");
  const json& all = member(root, "CalibrationInformation", name);
  const json& cameras = member(all, "Cameras", name);
  const json* depth = first_with(cameras, "Purpose", "CALIBRATION_CameraPurposeDepth");
  if (depth == nullptr) throw Error(name + ": \"Cameras\": expected one of CALIBRATION_CameraPurposeDepth");
  K4aCalibration calibration;
  calibration.depth = camera_of(*depth, name);
  if (calibration.depth.width != kSensorSide || calibration.depth.height != kSensorSide) {
    throw Error(fmt::format("{}: a depth sensor of {}x{} pixels, expected {}x{}", name, calibration.depth.width,
                            calibration.depth.height, kSensorSide, kSensorSide));
  }
  if (const json* colour = first_with(cameras, "Purpose", "CALIBRATION_CameraPurposePhotoVideo")) {
    calibration.colour = camera_of(*colour, name);
  }
  const auto sensors = all.find("InertialSensors");
  const json* accelerometer = sensors == all.end()
                                  ? nullptr
                                  : first_with(*sensors, "SensorType", "CALIBRATION_InertialSensorType_Accelerometer");
  if (accelerometer != nullptr) calibration.accelerometer_from_depth = transform_of(*accelerometer, name);
  return calibration;
}

std::optional<Calibration> k4a_depth_calibration(const K4aCalibration& calibration, int width, int height) {
  struct Mode {
    int width, height, sensor_side, left, top;
  };
  // Narrow modes are a part of the sensor, and binned ones have half its pixels.
  constexpr std::array<Mode, 4> kModes{{{640, 576, kSensorSide, 192, 180},
                                        {320, 288, kSensorSide / 2, 96, 90},
                                        {1024, 1024, kSensorSide, 0, 0},
                                        {512, 512, kSensorSide / 2, 0, 0}}};
  const auto mode =
      std::ranges::find_if(kModes, [&](const Mode& one) { return one.width == width && one.height == height; });
  if (mode == kModes.end()) return std::nullopt;
  Calibration found =
      of_pictures(calibration.depth, mode->sensor_side, mode->sensor_side, mode->left, mode->top, width, height);
  found.frame = kK4aDepthFrame;
  return found;
}

std::optional<Calibration> k4a_colour_calibration(const K4aCalibration& calibration, int width, int height) {
  if (!calibration.colour) return std::nullopt;
  const K4aCalibration::Sensor& sensor = *calibration.colour;
  // Pictures have the sensor's width and the middle of its height; old calibrations are those of such a band.
  const double scale = double(width) / sensor.width;
  const double sensor_height = scale * sensor.height;
  Calibration found = of_pictures(sensor, width, sensor_height, 0.0, (sensor_height - height) / 2.0, width, height);
  found.frame = kK4aColourFrame;
  return found;
}

K4aAcceleration parse_k4a_acceleration(std::string_view bytes, const std::string& name) {
  constexpr std::size_t kSample = 40;
  if (bytes.size() != kSample) {
    throw Error(fmt::format("{}: a measurement of {} bytes, expected {}", name, bytes.size(), kSample));
  }
  ByteReader in(bytes, name);
  K4aAcceleration sample;
  sample.time_ns = static_cast<std::int64_t>(in.number<std::uint64_t>("time of an acceleration"));
  for (double& axis : sample.m_s2) axis = double(in.real32("acceleration"));
  return sample;
}

}  // namespace vesalius
