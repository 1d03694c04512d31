#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "vesalius/fit/flesh_model.h"

namespace vesalius {

/// Triangles about the flesh of a body's bones, as docs/formats.md says it: rings around ellipses, with rounded ends.
/// Each bone has a closed surface of its own, as the viewer draws it.
struct FleshMesh {
  std::vector<Eigen::Vector3f> points;               ///< metres, each in the frame of its bone
  std::vector<Eigen::Vector3f> normals;              ///< [point]: outwards, length 1
  std::vector<std::uint8_t> bones;                   ///< [point]: place in the list of bones
  std::vector<std::uint16_t> triangles;              ///< three points each, counter-clockwise as seen from outside
  std::vector<std::vector<Eigen::Vector3f>> shapes;  ///< [shape][point]: what a standard deviation of it adds
};

/// Returns the mesh of some bones of the model for a shape, in standard deviations. `shapes` is exact but at the
/// rounded ends whose smaller half width becomes the other one.
FleshMesh flesh_mesh(const FleshModel& flesh, const std::vector<int>& bones, const Eigen::VectorXd& shape);

}  // namespace vesalius
