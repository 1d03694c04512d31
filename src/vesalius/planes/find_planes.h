#pragma once

#include <Eigen/Core>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "vesalius/camera.h"
#include "vesalius/image.h"
#include "vesalius/people_options.h"
#include "vesalius/person.h"

namespace vesalius {

/// Returns the largest flat surfaces of one picture, largest first: floor, walls, ceilings, large table-tops. They are
/// what a growing person leaks into. Sampling is seeded, so that the same picture has the same planes.
std::vector<Plane> find_planes(const DepthImage& depth, const Camera& camera, const PlaneOptions& options);

/// The large flat surfaces of one picture, and where they are seen.
struct FlatSurfaces {
  std::vector<Plane> planes;  ///< find_planes
  Mask pixels;                ///< flat_pixels
};
/// Searches once for both.
FlatSurfaces find_flat_surfaces(const DepthImage& depth, const Camera& camera, const PlaneOptions& options);

/// Returns the pixels of known surfaces, as flat_pixels.
Mask pixels_on(const std::vector<Plane>& planes, const DepthImage& depth, const Camera& camera,
               const PlaneOptions& options);

/// Returns 1 on the pixels of those surfaces. A pixel is on one if it lies in it and the surface about it is turned the
/// same way. Where a plane runs on through a person, the person is not on it.
Mask flat_pixels(const DepthImage& depth, const Camera& camera, const PlaneOptions& options);

/// Returns the floor among the planes of a picture: the lowest that is level and below the camera; nothing if none is.
/// `up` is the unit vector away from the ground in the optical frame. Without it the camera is taken to be tilted by
/// less than 60 degrees from where `guess` is up.
std::optional<Plane> find_floor(const std::vector<Plane>& planes, const std::optional<Eigen::Vector3f>& up,
                                const Eigen::Vector3f& guess = -Eigen::Vector3f::UnitY());

}  // namespace vesalius
