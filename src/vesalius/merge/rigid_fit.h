#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace vesalius {

/// The same point in two frames, metres, and the variance of their distance along each axis.
struct PointPair {
  Eigen::Vector3d to, from;
  double variance_m2 = 1.0;
};

/// The same floor in two frames: the unit vector away from it, and the height of the frame's origin over it.
struct FloorPair {
  Eigen::Vector3d to_up, from_up;
  double to_height_m = 0.0, from_height_m = 0.0;
};

/// Returns the transformation that brings `from` onto `to` at the least sum of squared distances over variances
/// (W. Kabsch 1976). Nothing for less than three points, or such as lie on a line.
std::optional<Eigen::Isometry3d> rigid_fit(const std::vector<PointPair>& pairs);

/// Returns the same from a first guess with distances that count less and less the further points are apart
/// (Geman-McClure), and, where it is known, with the floor. Errors of 25 pairs count as one, since those of one body
/// and of moments after each other are alike.
Eigen::Isometry3d rigid_refine(Eigen::Isometry3d guess, const std::vector<PointPair>& pairs,
                               const std::optional<FloorPair>& floor);

}  // namespace vesalius
