#pragma once

#include <Eigen/Core>
#include <cmath>
#include <string>
#include <vector>

#include "vesalius/base/camera.h"
#include "vesalius/base/image.h"
#include "vesalius/base/options.h"

namespace vesalius {

struct PlaneOptions {
  float min_area_m2 = 1.F;          ///< smallest surface that counts: no person shows this much flat
  float thickness_m = 0.02F;        ///< distance from the plane that still belongs to it
  float thickness_per_z2 = 0.003F;  ///< added per square metre of depth: sensor noise
};
void visit_options(const std::string& prefix, PlaneOptions& options, OptionVisitor& visitor);

/// The points p with normal . p = offset, in metres, optical frame. The normal has length 1, the offset is not
/// negative.
struct Plane {
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
  float offset = 0.F;
  float area_m2 = 0.F;  ///< visible surface on it

  float distance(const Eigen::Vector3f& p) const { return std::abs(normal.dot(p) - offset); }
};

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

/// Returns 1 on the pixels of those surfaces. A pixel is on one if it lies in it and the surface about it is turned the
/// same way. Where a plane runs on through a person, the person is not on it.
Mask flat_pixels(const DepthImage& depth, const Camera& camera, const PlaneOptions& options);

}  // namespace vesalius
