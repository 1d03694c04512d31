#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "synth/body/body_mesh.h"
#include "synth/body/limb.h"

namespace vesalius::synth {

/// Points of a grid whose lines need not be evenly spaced. The first x is minus the second, so that the cells between
/// them are cut in half by the plane x = 0.
struct HalfGrid {
  std::array<std::vector<float>, 3> lines;  ///< coordinates along x, y, z, rising, metres
};

struct Surface {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Triangle> triangles;  ///< counter-clockwise seen from outside
};

/// Returns the closed surface around limbs melted together: where the sum of exp(-distance / softness) is 1. Only the
/// half with x > 0 is worked out (surface nets, Gibson 1998) and the other is its mirror image to the last bit: vertex
/// for vertex, the middle ones shared at x = 0, triangle i + n/2 mirroring triangle i.
Surface melt(const std::vector<Limb>& limbs, float softness_m, const HalfGrid& grid);

}  // namespace vesalius::synth
