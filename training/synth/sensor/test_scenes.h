#pragma once

#include <cmath>
#include <numbers>

#include "synth/sensor/render.h"
#include "vesalius/base/random.h"

// Scenes of simple shapes, seen along z by a camera at the origin.
namespace vesalius::synth::test {

inline constexpr std::uint8_t kPart = 7;

inline View view_of(int width, int height, float focal_px) {
  View view;
  view.camera = {
      width, height, focal_px, focal_px, static_cast<float>(width - 1) / 2.F, static_cast<float>(height - 1) / 2.F};
  return view;
}

inline SceneMesh quad(const Eigen::Vector3f& corner, const Eigen::Vector3f& along, const Eigen::Vector3f& up) {
  SceneMesh mesh;
  mesh.vertices = {corner, corner + along, corner + along + up, corner + up};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

/// Returns a wide square that faces the camera.
inline SceneMesh wall(float z_m, float left_m = -50.F) {
  return quad({left_m, -50.F, z_m}, {50.F - left_m, 0.F, 0.F}, {0.F, 100.F, 0.F});
}

inline SceneMesh sphere(const Eigen::Vector3f& centre, float radius_m, int rings) {
  SceneMesh mesh;
  const int columns = 2 * rings;
  for (int i = 0; i <= rings; ++i) {
    const float polar = std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(rings);
    for (int j = 0; j < columns; ++j) {
      const float turn = 2.F * std::numbers::pi_v<float> * static_cast<float>(j) / static_cast<float>(columns);
      mesh.vertices.emplace_back(centre + radius_m * Eigen::Vector3f(std::sin(polar) * std::cos(turn), std::cos(polar),
                                                                     std::sin(polar) * std::sin(turn)));
    }
  }
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < columns; ++j) {
      const auto at = [&](int ring, int column) {
        return static_cast<std::uint32_t>(ring * columns + column % columns);
      };
      mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j)});
      mesh.triangles.push_back({at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)});
    }
  }
  return mesh;
}

inline SceneMesh of_person(SceneMesh mesh, int person) {
  mesh.person = person;
  mesh.part.assign(mesh.triangles.size(), kPart);
  return mesh;
}

/// Returns random triangles of random parts in front of the camera.
inline Scene confetti(int count) {
  Random random(5);
  SceneMesh mesh;
  mesh.person = 1;
  const auto within = [&](double reach) { return static_cast<float>(random.uniform(-reach, reach)); };
  for (int t = 0; t < count; ++t) {
    const Eigen::Vector3f centre(within(1.5), within(1.2), 3.F + within(1.0));
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int k = 0; k < 3; ++k)
      mesh.vertices.emplace_back(centre + Eigen::Vector3f(within(0.3), within(0.3), within(0.3)));
    mesh.triangles.push_back({base, base + 1, base + 2});
    mesh.part.push_back(static_cast<std::uint8_t>(random.below(25)));
  }
  Scene scene;
  scene.meshes = {mesh};
  return scene;
}

inline Scene mirrored(Scene scene) {
  for (SceneMesh& mesh : scene.meshes) {
    for (Eigen::Vector3f& p : mesh.vertices) p.x() = -p.x();
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  }
  return scene;
}

}  // namespace vesalius::synth::test
