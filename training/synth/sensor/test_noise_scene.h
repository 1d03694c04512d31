#pragma once

#include <algorithm>
#include <cmath>
#include <functional>

#include "synth/sensor/sensor_noise.h"

// Renderings made by hand for the tests of the sensors' noise.
namespace vesalius::synth::test {

/// Returns a bright, fully lit wall that faces the camera.
inline Rendering wall(const Camera& camera, float z_m) {
  Rendering r;
  r.view.camera = camera;
  r.depth_m = Image<float>(camera.width, camera.height, z_m);
  r.normal = Image<Eigen::Vector3f>(camera.width, camera.height, -Eigen::Vector3f::UnitZ());
  r.infrared = Image<float>(camera.width, camera.height, 0.6F);
  r.lit = Mask(camera.width, camera.height, 1);
  return r;
}

/// Returns the wall with a board in front of it, in columns [begin, end).
inline Rendering board(const Camera& camera, float near_m, float far_m, int begin, int end) {
  Rendering r = wall(camera, far_m);
  for (int v = 0; v < camera.height; ++v) std::fill(r.depth_m.row(v) + begin, r.depth_m.row(v) + end, near_m);
  return r;
}

/// Returns a preset without border, so that every pixel counts.
inline Sensor sensor_named(const char* name) {
  Sensor s = find_sensor(name);
  s.border_low = s.border_high = {};
  return s;
}

struct Statistics {
  double sigma_m = 0.0;
  double share_lost = 0.0;
};

/// Returns statistics over walls at and just beyond `z_m`, so that no step of the disparity is favoured.
inline Statistics statistics_of(const Sensor& sensor, float z_m, const std::function<void(Rendering&)>& change = {}) {
  double square = 0.0;
  int read = 0;
  int all = 0;
  for (std::uint64_t i = 0; i < 16; ++i) {
    Rendering r = wall(sensor.camera, z_m * (1.F + 0.0011F * float(i)));
    if (change) change(r);
    for (const std::uint16_t depth_mm : sense(r, sensor, Random(1, i))) {
      ++all;
      if (depth_mm == 0) continue;
      const double error = depth_mm * 1e-3 - r.depth_m[0];
      square += error * error;
      ++read;
    }
  }
  return {std::sqrt(square / std::max(1, read)), 1.0 - double(read) / all};
}

/// Turns every pixel's normal such that its ray meets the surface at this angle.
inline void tilt(Rendering& r, float angle_rad) {
  for (int v = 0; v < r.normal.height(); ++v) {
    for (int u = 0; u < r.normal.width(); ++u) {
      const Eigen::Vector3f ray = r.view.camera.point(float(u), float(v), 1.F).normalized();
      const Eigen::Vector3f aside = ray.cross(Eigen::Vector3f::UnitY()).normalized();
      r.normal(u, v) = -std::cos(angle_rad) * ray + std::sin(angle_rad) * aside;
    }
  }
}

}  // namespace vesalius::synth::test
