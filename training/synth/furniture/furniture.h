#pragma once

#include <algorithm>
#include <vector>

#include "synth/mesh/oriented_box.h"
#include "synth/mesh/palette.h"
#include "synth/mesh/scene_mesh.h"

namespace vesalius::synth {

/// A piece of furniture in its own frame: metres, y up, standing on y = 0 about the origin, with its front towards +z.
struct Furniture {
  SceneMesh mesh;
  std::vector<OrientedBox> solids;  ///< bodies and other things must stay out of these; they hold most of the mesh
};

/// Moves a piece with its mesh and solids.
void move(Furniture& piece, const Eigen::Isometry3f& motion);

/// Adds a piece to another in whose frame it is, with its solids.
void join(Furniture& piece, const Furniture& other);

/// Returns a motion that turns by `yaw_rad` about y (positive is counter-clockwise when seen from above) and then moves
/// to (x, height, z).
Eigen::Isometry3f standing_at(float x_m, float height_m, float z_m, float yaw_rad);

/// Composes a piece of furniture. Lengths are in metres and points in the piece's frame.
class FurnitureBuilder {
 public:
  explicit FurnitureBuilder(Random& random) : random_(random) {}

  std::uint8_t stuff(Stuff kind) { return add_material(piece.mesh, sample_material(kind, random_)); }

  /// Adds a look that is black with a probability: then it sends back next to no infrared light.
  std::uint8_t perhaps_black(Stuff kind, double probability);

  /// Adds an upright box that is solid.
  void box(const Eigen::Vector3f& low, const Eigen::Vector3f& high, std::uint8_t material) {
    add_box(piece.mesh, low, high, material);
    solid(low, high);
  }
  /// Adds a tilted box that is solid.
  void box(const Eigen::Isometry3f& pose, const Eigen::Vector3f& size, std::uint8_t material) {
    add_box(piece.mesh, pose, size, material);
    piece.solids.push_back({pose, 0.5F * size});
  }
  /// Adds an upright round post that is solid.
  void post(float x, float z, float low, float high, float radius, std::uint8_t material) {
    cone({x, low, z}, {x, high, z}, radius, radius, material);
  }
  /// Adds an upright cone whose bounding box is solid.
  void cone(const Eigen::Vector3f& from, const Eigen::Vector3f& to, float from_radius, float to_radius,
            std::uint8_t material) {
    add_cone(piece.mesh, from, to, from_radius, to_radius, material, 12);
    const float reach = std::max(from_radius, to_radius);
    solid(from.cwiseMin(to) - Eigen::Vector3f(reach, 0.F, reach),
          from.cwiseMax(to) + Eigen::Vector3f(reach, 0.F, reach));
  }
  /// Adds a round rod that is solid.
  void rod(const Eigen::Vector3f& from, const Eigen::Vector3f& to, float radius, std::uint8_t material);
  /// Adds a round rod that is not solid, as it is thin, limp, or beside something solid.
  void thin(const Eigen::Vector3f& from, const Eigen::Vector3f& to, float radius, std::uint8_t material) {
    add_cone(piece.mesh, from, to, radius, radius, material, 6);
  }
  /// Adds a wheel that turns about an axis, with a rim and spokes, or a disc. It is solid.
  void wheel(const Eigen::Vector3f& centre, const Eigen::Vector3f& axis, float radius, float width, bool spokes,
             std::uint8_t material);
  /// Adds feet on castors about the origin that meet at a hub. They are solid.
  void star(int feet, float reach, float hub_m, std::uint8_t material);
  /// Adds four legs under a board whose corners are at +-x and z_low, z_high.
  void legs(float x, float z_low, float z_high, float height, float thickness, std::uint8_t material) {
    for (const float z : {z_low, z_high - thickness}) {
      for (const float left : {-x, x - thickness}) {
        box({left, 0.F, z}, {left + thickness, height, z + thickness}, material);
      }
    }
  }
  /// Flattens what is below the floor, as of soft or limp things that lie on it.
  void press_on_floor() {
    for (Eigen::Vector3f& p : piece.mesh.vertices) p.y() = std::max(p.y(), 0.F);
  }
  void solid(const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
    piece.solids.push_back({placed_at(0.5F * (low + high)), 0.5F * (high - low)});
  }

  Furniture piece;

 private:
  Random& random_;
};

}  // namespace vesalius::synth
