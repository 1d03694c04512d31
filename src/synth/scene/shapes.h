#pragma once

#include <Eigen/Geometry>
#include <cstdint>

#include "synth/scene/scene.h"

namespace vesalius::synth {

// Simple solids, added to a mesh. Metres; `material` is an index in the mesh's materials.

/// The index under which the mesh has the material from now on. A mesh has room for 256.
std::uint8_t add_material(SceneMesh& mesh, const Material& material);

/// Box of that size; the pose's origin is its centre.
void add_box(SceneMesh& mesh, const Eigen::Isometry3f& pose, const Eigen::Vector3f& size, std::uint8_t material);
/// Upright box between two corners.
void add_box(SceneMesh& mesh, const Eigen::Vector3f& low, const Eigen::Vector3f& high, std::uint8_t material);

/// Cylinder or cone with both ends closed.
void add_cone(SceneMesh& mesh, const Eigen::Vector3f& from, const Eigen::Vector3f& to, float from_radius,
              float to_radius, std::uint8_t material, int sides = 10);

/// Ellipsoid with the given half axes.
void add_ellipsoid(SceneMesh& mesh, const Eigen::Isometry3f& pose, const Eigen::Vector3f& half, std::uint8_t material,
                   int rings = 8);

/// Four corners in order round a flat or nearly flat face.
void add_quad(SceneMesh& mesh, const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c,
              const Eigen::Vector3f& d, std::uint8_t material);

/// Hanging cloth between two upper corners, `drop_m` long, in folds of the given depth.
void add_curtain(SceneMesh& mesh, const Eigen::Vector3f& left, const Eigen::Vector3f& right, float drop_m, float fold_m,
                 int folds, std::uint8_t material);

/// Moves all vertices.
void move(SceneMesh& mesh, const Eigen::Isometry3f& motion);

}  // namespace vesalius::synth
