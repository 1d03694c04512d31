#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "vesalius/base/frame_truth.h"

namespace vesalius {

/// Where a camera was over time: groundtruth.txt of the TUM RGB-D benchmark.
class Trajectory {
 public:
  /// Lines "timestamp tx ty tz qx qy qz qw": seconds, metres, and the rotation of the camera's optical frame in the
  /// world; empty lines and those after # are skipped. `name` stands for the file in errors. Throws Error with the line
  /// for one of another form, a quaternion that is none and a time that does not come after the one before.
  static Trajectory parse(std::string_view text, const std::string& name);
  static Trajectory read(const std::string& path);

  /// World from camera at a time, between its neighbours along the shortest way; nothing outside the recording and in
  /// gaps of more than 0.15 s.
  std::optional<Eigen::Isometry3d> world_from_camera(double time_s) const;

  /// From the poses 50 ms before and after: moving from 0.05 m/s or 5 degrees/s on; unknown where either is missing.
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
