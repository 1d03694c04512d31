#pragma once

#include <Eigen/Core>

namespace vesalius {

/// Pinhole camera of any size and focal length, in pixels. Pixel centres are at integer coordinates.
/// Points are metres in the optical frame: x right, y down, z forward.
struct Camera {
  int width = 0;
  int height = 0;
  float fx = 0.F;  ///< focal length, pixels
  float fy = 0.F;
  float cx = 0.F;  ///< principal point, pixels
  float cy = 0.F;

  /// Returns the point seen by pixel (u, v) at `z_m` metres along the optical axis.
  Eigen::Vector3f point(float u, float v, float z_m) const { return {(u - cx) / fx * z_m, (v - cy) / fy * z_m, z_m}; }

  /// Returns the pixel (u, v) of a point with z > 0.
  Eigen::Vector2f pixel(const Eigen::Vector3f& p) const { return {p.x() / p.z() * fx + cx, p.y() / p.z() * fy + cy}; }

  /// Returns the camera of the same view at another picture size (e.g. depth at half resolution).
  Camera resized(int new_width, int new_height) const;

  friend bool operator==(const Camera&, const Camera&) = default;
};

/// Throws Error unless size and focal lengths are positive and finite and the principal point is finite.
void check(const Camera& camera);

}  // namespace vesalius
