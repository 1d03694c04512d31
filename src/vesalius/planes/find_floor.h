#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "vesalius/planes/find_planes.h"

namespace vesalius {

/// Returns the floor among the planes of a picture: the lowest that is level and below the camera; nothing if none is.
/// `up` is the unit vector away from the ground in the optical frame. Without it the camera is taken to be held upright
/// and tilted by less than 60 degrees.
std::optional<Plane> find_floor(const std::vector<Plane>& planes, const std::optional<Eigen::Vector3f>& up);

}  // namespace vesalius
