#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "synth/body/body_mesh.h"
#include "vesalius/image.h"

namespace vesalius::synth {

/// The pattern of a surface, as a function of the position on it.
enum class Texture : std::uint8_t { plain, stripes, checks, speckle };

/// The appearance of a surface to the colour camera and the depth sensor.
struct Material {
  Rgb colour{180, 180, 180};
  Rgb second{180, 180, 180};  ///< second colour of the pattern
  Texture texture = Texture::plain;
  float period_m = 0.1F;  ///< period of the pattern
  float infrared = 0.6F;  ///< reflected share of the sensor's light, 0-1; dark hair and black plastic are near 0.05
};

/// A surface in the world (y up, floor at y = 0, metres).
struct SceneMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Triangle> triangles;
  std::vector<std::uint8_t> part;      ///< for each triangle; empty if all are kBackground
  std::vector<std::uint8_t> material;  ///< for each triangle, an index in `materials`; empty if all are 0
  std::vector<Material> materials;
  int person = -1;  ///< index of the person, or -1; a person's triangles of part kBackground count as nobody's
};

// These functions add simple solids to a mesh. Lengths are in metres; `material` is an index in the mesh's materials.

/// Adds a material and returns its index. A mesh has room for 256.
std::uint8_t add_material(SceneMesh& mesh, const Material& material);

/// Returns a pose at a place without any turn.
Eigen::Isometry3f placed_at(const Eigen::Vector3f& place);

/// Adds a box of the given size. The pose's origin is its centre.
void add_box(SceneMesh& mesh, const Eigen::Isometry3f& pose, const Eigen::Vector3f& size, std::uint8_t material);
/// Adds an upright box between two corners.
void add_box(SceneMesh& mesh, const Eigen::Vector3f& low, const Eigen::Vector3f& high, std::uint8_t material);

/// Adds a cylinder or cone with both ends closed.
void add_cone(SceneMesh& mesh, const Eigen::Vector3f& from, const Eigen::Vector3f& to, float from_radius,
              float to_radius, std::uint8_t material, int sides = 10);

/// Adds an ellipsoid with the given half axes.
void add_ellipsoid(SceneMesh& mesh, const Eigen::Isometry3f& pose, const Eigen::Vector3f& half, std::uint8_t material,
                   int rings = 8);

/// Adds a cushion with the given half sizes: an ellipsoid with fuller corners.
void add_cushion(SceneMesh& mesh, const Eigen::Isometry3f& pose, const Eigen::Vector3f& half, std::uint8_t material);

/// A level ellipse about a point.
struct Ring {
  Eigen::Vector3f centre;
  float half_x = 0.F, half_z = 0.F;
};
/// Adds a cloth that hangs around two or more rings, from the first, where it is closed, down to the last. It has so
/// many folds, which deepen from none at the first ring to `fold_m` at the last.
void add_garment(SceneMesh& mesh, std::span<const Ring> rings, int folds, float fold_m, std::uint8_t material);

/// Adds a flat or nearly flat face with four corners, which are given in order around it.
void add_quad(SceneMesh& mesh, const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c,
              const Eigen::Vector3f& d, std::uint8_t material);

/// Adds a cloth of length `drop_m` that hangs between two upper corners, in folds of the given depth.
void add_curtain(SceneMesh& mesh, const Eigen::Vector3f& left, const Eigen::Vector3f& right, float drop_m, float fold_m,
                 int folds, std::uint8_t material);

/// Moves all vertices.
void move(SceneMesh& mesh, const Eigen::Isometry3f& motion);

}  // namespace vesalius::synth
