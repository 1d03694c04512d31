#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "synth/body/body_mesh.h"

namespace vesalius::synth {

/// A body's surface by fewer triangles, for who stands so far away that nobody can tell.
struct CoarseSurface {
  float error_m = 0.F;                ///< bound asked for, metres
  std::vector<std::uint32_t> vertex;  ///< vertices of the mesh that are left, ascending
  std::vector<Triangle> triangles;    ///< of indices in `vertex`
  std::vector<std::uint8_t> part;     ///< per triangle, as in BodyTopology
  std::vector<std::uint8_t> fabric;   ///< per triangle: Fabric as a number
};

/// Thins a surface by moving vertices onto neighbours as long as the triangles about them stay within the bound: one
/// result per bound, each thinned on from the one before. The error is the root mean square distance from the planes of
/// all triangles that a vertex has stood for (quadrics of Garland and Heckbert 1997), measured in `points`, the mesh's
/// vertices in some pose: one with all joints half bent, or what is flat at rest would not bend. Borders between parts
/// and fabrics and open edges keep their course to the same bound. `errors_m` must rise. Same arguments, same result.
std::vector<CoarseSurface> simplify(const BodyTopology& topology, const std::vector<Eigen::Vector3f>& points,
                                    const std::vector<float>& errors_m);

}  // namespace vesalius::synth
