#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "vesalius/base/camera.h"
#include "vesalius/base/image.h"

namespace vesalius {

/// All points near a line from one point to another, within a radius that changes evenly along it. Metres.
struct Capsule {
  Eigen::Vector3f from = Eigen::Vector3f::Zero(), to = Eigen::Vector3f::Zero();
  float from_radius = 0.F, to_radius = 0.F;

  /// Returns how far a point is outside, below 0 inside.
  float distance(const Eigen::Vector3f& point) const {
    const Eigen::Vector3f axis = to - from, offset = point - from;
    const float along = std::clamp(offset.dot(axis) / std::max(axis.squaredNorm(), 1e-8F), 0.F, 1.F);
    return (offset - along * axis).norm() - (from_radius + along * (to_radius - from_radius));
  }
};

/// Returns the part of the camera's picture in which points of a capsule can be seen. If it is nearer than its own
/// radius, that may be the whole picture.
Box box_around(const Capsule& capsule, const Camera& camera);

}  // namespace vesalius
