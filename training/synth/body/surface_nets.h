#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "synth/body/body_mesh.h"
#include "synth/body/limb.h"

namespace vesalius::synth {

/// A grid whose lines need not be evenly spaced. The first x is minus the second, so that the plane x = 0 halves the
/// cells between them.
struct HalfGrid {
  std::array<std::vector<float>, 3> lines;  ///< coordinates along x, y, z in rising order, metres
};

struct Surface {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Triangle> triangles;  ///< counter-clockwise when seen from outside
};

/// Returns the closed surface around limbs that are melted together: the set where the sum of exp(-distance / softness)
/// is 1. Only the half with x > 0 is computed (surface nets, Gibson 1998); the other half is its exact mirror image.
/// Vertices on x = 0 are shared, and triangle i + n/2 mirrors triangle i.
Surface melt(const std::vector<Limb>& limbs, float softness_m, const HalfGrid& grid);

}  // namespace vesalius::synth
