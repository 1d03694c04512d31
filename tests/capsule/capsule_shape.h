#pragma once

#include <Eigen/Core>
#include <optional>

namespace vesalius {

/// The points within one unit of the segment (0, -half_length, 0) .. (0, half_length, 0), stretched by `scale_m`,
/// turned and moved. This is a capsule, a flattened capsule, or with half_length 0 an ellipsoid or sphere.
struct CapsuleShape {
  Eigen::Matrix3d world_from_shape = Eigen::Matrix3d::Identity();  ///< rotation
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();              ///< metres, world
  Eigen::Vector3d scale_m = Eigen::Vector3d::Ones();               ///< half axes of the ends, metres
  double half_length = 0.0;  ///< half length of the straight part, in units of scale_m.y

  /// Returns the world position of a point in shape units.
  Eigen::Vector3d world(const Eigen::Vector3d& local) const {
    return centre_m + world_from_shape * local.cwiseProduct(scale_m);
  }
};

/// The point where a ray enters a shape.
struct ShapeHit {
  double t = 0.0;         ///< multiple of the ray's direction
  Eigen::Vector3d local;  ///< entry point in shape units
};

/// Returns where the ray origin + t direction, t > 0, first enters the shape, or nothing if it misses the shape or
/// starts inside it.
std::optional<ShapeHit> intersect(const CapsuleShape& shape, const Eigen::Vector3d& origin,
                                  const Eigen::Vector3d& direction);

/// Returns the outward unit normal (world) at an entry point in shape units.
Eigen::Vector3d normal(const CapsuleShape& shape, const Eigen::Vector3d& local);

/// A slab low <= y <= high of a shape, cut in halves by its plane x = 0.
struct Slab {
  double half_volume_m3 = 0.0;  ///< of each half
  double y = 0.0;               ///< centroid along the axis, shape units
  double x = 0.0;               ///< distance of a half's centroid from the plane, shape units
};

/// Returns volume and centroids of the slab from `low` to `high` (shape units, clamped to the shape), to better than
/// 0.1 %.
Slab measure_slab(const CapsuleShape& shape, double low, double high);

}  // namespace vesalius
