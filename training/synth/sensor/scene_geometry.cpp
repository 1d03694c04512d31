#include "synth/sensor/scene_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

using Quad = SceneGeometry::Quad;

[[noreturn]] void fail(std::size_t mesh, const std::string& what) {
  throw Error(fmt::format("scene mesh {}: {}", mesh, what));
}

void check(const SceneMesh& mesh, std::size_t number) {
  const std::size_t count = mesh.triangles.size();
  for (std::size_t t = 0; t < count; ++t) {
    for (const std::uint32_t corner : mesh.triangles[t]) {
      if (corner < mesh.vertices.size()) continue;
      fail(number, fmt::format("triangle {} has vertex {}, expected less than {}", t, corner, mesh.vertices.size()));
    }
  }
  if (!mesh.part.empty() && mesh.part.size() != count) {
    fail(number, fmt::format("{} parts for {} triangles", mesh.part.size(), count));
  }
  if (!mesh.material.empty() && mesh.material.size() != count) {
    fail(number, fmt::format("{} materials for {} triangles", mesh.material.size(), count));
  }
  const std::size_t known = std::max<std::size_t>(1, mesh.materials.size());
  for (const std::uint8_t material : mesh.material) {
    if (material >= known) fail(number, fmt::format("material {}, expected less than {}", material, known));
  }
  for (const Material& material : mesh.materials) {
    if (material.infrared >= 0.F && material.infrared <= 1.F && std::isfinite(material.period_m)) continue;
    fail(number, "a material's infrared must be 0 to 1 and its period finite");
  }
  if (mesh.person < -1 || mesh.person >= kBackground) {
    fail(number, fmt::format("person {}, expected -1 to {}", mesh.person, kBackground - 1));
  }
}

/// Returns the two triangles as a quad if they share an edge and have the same orientation.
std::optional<Quad> joined(const Triangle& a, const Triangle& b) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t first = a[i], second = a[(i + 1) % 3];
    for (std::size_t j = 0; j < 3; ++j) {
      if (b[j] == second && b[(j + 1) % 3] == first) return Quad{a[(i + 2) % 3], first, b[(j + 2) % 3], second};
    }
  }
  return std::nullopt;
}

}  // namespace

void SceneGeometry::add_vertices(const SceneMesh& mesh, std::size_t number) {
  const std::size_t base = vertices.size();
  vertices.resize(base + mesh.vertices.size());
  outside_.resize(vertices.size());
  float sum = 0.F;  // finite if every coordinate is
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3f p = camera_from_world_ * mesh.vertices[i];
    sum += 0.F * (p.x() + p.y() + p.z());
    unsigned bits = 0;
    for (std::size_t k = 0; k < planes_.size(); ++k) {
      bits |= static_cast<unsigned>(planes_[k].normal.dot(p) < planes_[k].offset) << k;
    }
    vertices[base + i] = p;
    outside_[base + i] = static_cast<std::uint8_t>(bits);
  }
  if (sum == 0.F) return;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (!(camera_from_world_ * mesh.vertices[i]).allFinite()) fail(number, fmt::format("vertex {} is not finite", i));
  }
  fail(number, "a vertex is too far away");
}

void SceneGeometry::add_triangles(const SceneMesh& mesh, std::uint32_t first_vertex, std::size_t first_material) {
  const auto shifted = [&](std::size_t t) {
    const Triangle& corners = mesh.triangles[t];
    return Triangle{corners[0] + first_vertex, corners[1] + first_vertex, corners[2] + first_vertex};
  };
  const auto seen = [&](const Triangle& t) { return (outside_[t[0]] & outside_[t[1]] & outside_[t[2]]) == 0; };
  const auto face = [&](std::size_t t) {
    const std::uint8_t part = mesh.part.empty() ? kBackground : mesh.part[t];
    const bool of_person = mesh.person >= 0 && part != kBackground;
    const std::size_t material = first_material + (mesh.material.empty() ? 0 : mesh.material[t]);
    return Face{part, of_person ? static_cast<std::uint8_t>(mesh.person) : kBackground,
                static_cast<std::uint16_t>(material)};
  };
  const std::size_t count = mesh.triangles.size();
  for (std::size_t t = 0; t < count; ++t) {
    const Triangle a = shifted(t);
    if (const auto quad = t + 1 < count ? joined(a, shifted(t + 1)) : std::nullopt) {
      if (seen(a) || seen(shifted(t + 1))) {
        quads.push_back(*quad);
        faces.push_back({face(t), face(t + 1)});
      }
      ++t;
    } else if (seen(a)) {
      quads.push_back({a[0], a[1], a[2], a[2]});
      faces.push_back({face(t), face(t)});
    }
  }
}

void SceneGeometry::add(const SceneMesh& mesh, std::size_t number) {
  check(mesh, number);
  const auto first_vertex = static_cast<std::uint32_t>(vertices.size());
  const std::size_t first_material = materials.size();
  add_vertices(mesh, number);
  if (mesh.materials.empty()) materials.emplace_back();
  materials.insert(materials.end(), mesh.materials.begin(), mesh.materials.end());
  if (materials.size() > 65535) fail(number, "more than 65535 materials in the scene");
  add_triangles(mesh, first_vertex, first_material);
}

void SceneGeometry::set_planes(const Camera& camera, const std::optional<Eigen::Vector3f>& projector) {
  // These are the sides of the view, a pixel wider, and moved outwards such that shadow rays to the projector stay
  // inside.
  const float left = (-1.F - camera.cx) / camera.fx;
  const float right = (float(camera.width) - camera.cx) / camera.fx;
  const float top = (-1.F - camera.cy) / camera.fy;
  const float bottom = (float(camera.height) - camera.cy) / camera.fy;
  const std::array<Eigen::Vector3f, 5> normals = {Eigen::Vector3f(1.F, 0.F, -left), Eigen::Vector3f(-1.F, 0.F, right),
                                                  Eigen::Vector3f(0.F, 1.F, -top), Eigen::Vector3f(0.F, -1.F, bottom),
                                                  Eigen::Vector3f(0.F, 0.F, 1.F)};
  for (std::size_t k = 0; k < normals.size(); ++k) {
    const float reach = projector ? std::min(0.F, normals[k].dot(*projector)) : 0.F;
    planes_[k] = {normals[k], reach - 1e-3F};
  }
}

void SceneGeometry::gather(const Scene& scene, const View& view, const std::optional<Eigen::Vector3f>& projector) {
  vertices.clear();
  quads.clear();
  faces.clear();
  materials.clear();
  outside_.clear();
  if (!view.camera_from_world.matrix().allFinite()) throw Error("view: camera_from_world is not finite");
  camera_from_world_ = view.camera_from_world;

  set_planes(view.camera, projector);
  std::size_t vertex_count = 1;
  for (const SceneMesh& mesh : scene.meshes) vertex_count += mesh.vertices.size();
  vertices.reserve(vertex_count);
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) add(scene.meshes[m], m);
  vertices.emplace_back(Eigen::Vector3f::Zero());
}

}  // namespace vesalius::synth
