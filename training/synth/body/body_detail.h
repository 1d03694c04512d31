#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "synth/body/poser.h"

namespace vesalius::synth {

/// A body's surface with fewer triangles, for people who are too far away to show the difference.
struct CoarseSurface {
  float error_m = 0.F;                ///< requested error bound in metres
  std::vector<std::uint32_t> vertex;  ///< remaining vertices of the mesh, ascending
  std::vector<Triangle> triangles;    ///< corners are indices into `vertex`
  std::vector<std::uint8_t> part;     ///< for each triangle, as in BodyTopology
  std::vector<std::uint8_t> fabric;   ///< for each triangle its Fabric as a number
};

/// Simplifies a surface by moving vertices onto neighbours as long as the triangles around them stay within the error
/// bound (meshopt_simplify). There is one result for each bound; each continues from the previous one, so `errors_m`
/// must rise. The error is the root mean square distance from the planes of all triangles that a vertex has replaced
/// (quadrics of Garland and Heckbert 1997). It is measured in `points`, the mesh's vertices in some pose. All joints
/// should be half bent in it, because surfaces that are flat in `points` lose the vertices that they need to bend.
/// Borders between parts and fabrics and open edges keep their course within the same bound. The same arguments give
/// the same result.
std::vector<CoarseSurface> simplify(const BodyTopology& topology, const std::vector<Eigen::Vector3f>& points,
                                    const std::vector<float>& errors_m);

/// Coarser surfaces of one body, computed once. Their vertices are a subset of the body's own, so they fit any pose of
/// it.
class BodyDetail {
 public:
  explicit BodyDetail(const Poser& poser);

  /// Returns the coarsest surface that differs from the full one by at most `error_m`, or null if none does.
  const CoarseSurface* within(float error_m) const;

 private:
  std::vector<CoarseSurface> levels_;  ///< each one coarser than the previous
};

}  // namespace vesalius::synth
