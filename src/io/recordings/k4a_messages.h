#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "io/recordings/camera_messages.h"

namespace vesalius {

/// The factory's calibration of an Azure Kinect or Femto, which their recordings hold as calibration.json: the same for
/// all modes, in shares of the sensor's size, pixel centres at halves. Frames are named by who sees them.
struct K4aCalibration {
  struct Sensor {
    double cx = 0.0, cy = 0.0, fx = 0.0, fy = 0.0;  ///< shares of width and height
    int width = 0, height = 0;                      ///< width and height of the sensor, pixels
    std::array<double, 8> distortion{};             ///< coefficients of rational_polynomial: k1 k2 p1 p2 k3 k4 k5 k6
    Eigen::Isometry3d sensor_from_depth = Eigen::Isometry3d::Identity();  ///< metres
  };
  Sensor depth;
  std::optional<Sensor> colour;
  std::optional<Eigen::Isometry3d> accelerometer_from_depth;
};

inline constexpr const char* kK4aDepthFrame = "depth_camera";
inline constexpr const char* kK4aColourFrame = "color_camera";
inline constexpr const char* kK4aAccelerometerFrame = "accelerometer";

/// Reads calibration.json. Throws Error naming `name`, the key and what was expected.
K4aCalibration parse_k4a_calibration(std::string_view json, const std::string& name);

/// Returns the calibration of depth pictures: narrow (640x576, 320x288) and wide (1024x1024, 512x512). Nothing for
/// pictures of another size.
std::optional<Calibration> k4a_depth_calibration(const K4aCalibration& calibration, int width, int height);

/// Returns the calibration of colour pictures, 4:3 or a band of that, such as 16:9; nothing where the recording has
/// none.
std::optional<Calibration> k4a_colour_calibration(const K4aCalibration& calibration, int width, int height);

/// Returns an acceleration as a recording's track has it: time, acceleration, time, angular velocity. Throws Error
/// naming `name` if it is none.
struct K4aAcceleration {
  std::int64_t time_ns = 0;
  Eigen::Vector3d m_s2 = Eigen::Vector3d::Zero();
};
K4aAcceleration parse_k4a_acceleration(std::string_view bytes, const std::string& name);

}  // namespace vesalius
