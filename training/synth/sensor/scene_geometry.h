#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "synth/scene/scene.h"

namespace vesalius::synth {

/// The properties of a triangle.
struct Face {
  std::uint8_t part = kBackground;
  std::uint8_t person = kBackground;
  std::uint16_t material = 0;  ///< index in SceneGeometry::materials
};

/// The triangles of a scene that a view can see, in the camera frame and ready for a ray caster. Neighbouring triangles
/// are joined to quads, which halves the ray caster's work.
struct SceneGeometry {
  /// Corners 0, 1, 3 are the first triangle and 2, 3, 1 the second. If there is no second triangle, corner 2 equals 3.
  using Quad = std::array<std::uint32_t, 4>;

  std::vector<Eigen::Vector3f> vertices;  ///< metres; one extra vertex, because Embree reads 16 bytes for each
  std::vector<Quad> quads;
  std::vector<std::array<Face, 2>> faces;  ///< for each quad, its two triangles
  std::vector<Material> materials;

  /// Fills this object and reuses its memory. Triangles are left out if no ray from the camera and none from the
  /// visible surfaces to `projector` (camera frame, metres) can meet them. Throws Error naming the mesh for an index
  /// out of range, a list of the wrong length, or a number that is not finite.
  void gather(const Scene& scene, const View& view, const std::optional<Eigen::Vector3f>& projector);

 private:
  void add(const SceneMesh& mesh, std::size_t number);
  void set_planes(const Camera& camera, const std::optional<Eigen::Vector3f>& projector);
  void add_triangles(const SceneMesh& mesh, std::uint32_t first_vertex, std::size_t first_material);
  void add_vertices(const SceneMesh& mesh, std::size_t number);

  struct Plane {
    Eigen::Vector3f normal;  ///< points inwards
    float offset;
  };
  std::array<Plane, 5> planes_;
  Eigen::Isometry3f camera_from_world_;
  std::vector<std::uint8_t> outside_;  ///< for each vertex, one bit for each plane beyond which it lies
};

}  // namespace vesalius::synth
