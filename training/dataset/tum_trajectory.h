#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "metrics/frame_truth.h"

namespace vesalius {

/// The poses of a camera over time: groundtruth.txt of the TUM RGB-D benchmark.
class Trajectory {
 public:
  /// Reads lines of the form "timestamp tx ty tz qx qy qz qw": seconds, metres, and the rotation of the camera's
  /// optical frame in the world. Empty lines and those that begin with # are skipped. `name` is used as the path in
  /// errors. Throws Error with the line if a line has another form, its quaternion is not of unit length, or its time
  /// is not after the previous one.
  static Trajectory parse(std::string_view text, const std::string& name);
  static Trajectory read(const std::string& path);

  /// Returns the transformation from camera to world at a time, interpolated between the two nearest poses. Returns
  /// nothing outside the recording and in gaps of more than 0.15 s.
  std::optional<Eigen::Isometry3d> world_from_camera(double time_s) const;

  /// Tells whether the camera moves, from the poses 50 ms before and after. It is moving from 0.05 m/s or 5 degrees/s
  /// on, and unknown if either pose is missing.
  CameraMotion motion(double time_s) const;

 private:
  struct Pose {
    double time_s = 0.0;
    Eigen::Vector3d position_m;
    Eigen::Quaterniond rotation;
  };
  std::vector<Pose> poses_;  ///< by time
};

}  // namespace vesalius
