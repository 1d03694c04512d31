#include "synth/mesh/scene_mesh.h"

#include <cassert>
#include <cmath>
#include <numbers>

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

constexpr float kPi = std::numbers::pi_v<float>;

std::uint32_t vertex_count(const SceneMesh& mesh) { return static_cast<std::uint32_t>(mesh.vertices.size()); }

void add_triangle(SceneMesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint8_t material) {
  mesh.triangles.push_back({a, b, c});
  mesh.material.push_back(material);
}

/// Adds strips between consecutive rings of `count` vertices each, starting at vertex `base`.
void join_rings(SceneMesh& mesh, std::uint32_t base, int rings, int count, bool closed, std::uint8_t material) {
  const int columns = closed ? count : count - 1;
  const auto at = [&](int ring, int column) {
    return base + static_cast<std::uint32_t>(ring * count + column % count);
  };
  for (int i = 0; i + 1 < rings; ++i) {
    for (int j = 0; j < columns; ++j) {
      add_triangle(mesh, at(i, j), at(i, j + 1), at(i + 1, j + 1), material);
      add_triangle(mesh, at(i, j), at(i + 1, j + 1), at(i + 1, j), material);
    }
  }
}

/// Adds a sphere that is scaled to `half` after `shape` was applied to each coordinate of its unit vectors.
template <class Shape>
void add_round(SceneMesh& mesh, const Eigen::Isometry3f& pose, const Vector3f& half, int rings, std::uint8_t material,
               Shape shape) {
  const std::uint32_t base = vertex_count(mesh);
  const int columns = rings + rings / 2;
  for (int i = 0; i <= rings; ++i) {
    const float polar = kPi * float(i) / float(rings);
    for (int j = 0; j < columns; ++j) {
      const float turn = -2.F * kPi * float(j) / float(columns);
      const Vector3f unit(std::sin(polar) * std::cos(turn), std::cos(polar), std::sin(polar) * std::sin(turn));
      mesh.vertices.emplace_back(pose * half.cwiseProduct(unit.unaryExpr(shape)));
    }
  }
  join_rings(mesh, base, rings + 1, columns, true, material);
}

}  // namespace

std::uint8_t add_material(SceneMesh& mesh, const Material& material) {
  assert(mesh.materials.size() < 256);
  mesh.materials.push_back(material);
  return static_cast<std::uint8_t>(mesh.materials.size() - 1);
}

Eigen::Isometry3f placed_at(const Vector3f& place) {
  Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
  pose.translation() = place;
  return pose;
}

void add_box(SceneMesh& mesh, const Eigen::Isometry3f& pose, const Vector3f& size, std::uint8_t material) {
  const std::uint32_t base = vertex_count(mesh);
  for (unsigned i = 0; i < 8; ++i) {
    const Vector3f corner((i & 1U) != 0 ? 0.5F : -0.5F, (i & 2U) != 0 ? 0.5F : -0.5F, (i & 4U) != 0 ? 0.5F : -0.5F);
    mesh.vertices.emplace_back(pose * corner.cwiseProduct(size));
  }
  constexpr std::array<std::array<std::uint32_t, 4>, 6> kFaces = {
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& f : kFaces) {
    add_triangle(mesh, base + f[0], base + f[1], base + f[2], material);
    add_triangle(mesh, base + f[0], base + f[2], base + f[3], material);
  }
}

void add_box(SceneMesh& mesh, const Vector3f& low, const Vector3f& high, std::uint8_t material) {
  add_box(mesh, placed_at(0.5F * (low + high)), high - low, material);
}

void add_cone(SceneMesh& mesh, const Vector3f& from, const Vector3f& to, float from_radius, float to_radius,
              std::uint8_t material, int sides) {
  const std::uint32_t base = vertex_count(mesh);
  const Vector3f axis = (to - from).normalized();
  const Vector3f side = axis.unitOrthogonal();
  const Vector3f other = axis.cross(side);
  for (int end = 0; end < 2; ++end) {
    const float radius = end == 0 ? from_radius : to_radius;
    for (int j = 0; j < sides; ++j) {
      const float turn = 2.F * kPi * float(j) / float(sides);
      mesh.vertices.emplace_back((end == 0 ? from : to) + radius * (std::cos(turn) * side + std::sin(turn) * other));
    }
  }
  join_rings(mesh, base, 2, sides, true, material);
  const auto count = static_cast<std::uint32_t>(sides);
  for (std::uint32_t j = 1; j + 1 < count; ++j) {
    add_triangle(mesh, base, base + j + 1, base + j, material);
    add_triangle(mesh, base + count, base + count + j, base + count + j + 1, material);
  }
}

void add_ellipsoid(SceneMesh& mesh, const Eigen::Isometry3f& pose, const Vector3f& half, std::uint8_t material,
                   int rings) {
  add_round(mesh, pose, half, rings, material, [](float v) { return v; });
}

void add_cushion(SceneMesh& mesh, const Eigen::Isometry3f& pose, const Vector3f& half, std::uint8_t material) {
  add_round(mesh, pose, half, 9, material, [](float v) { return std::copysign(std::sqrt(std::abs(v)), v); });
}

void add_garment(SceneMesh& mesh, std::span<const Ring> rings, int folds, float fold_m, std::uint8_t material) {
  assert(rings.size() >= 2);
  constexpr int kColumns = 24;
  const std::uint32_t base = vertex_count(mesh);
  for (std::size_t i = 0; i < rings.size(); ++i) {
    const float depth = 0.5F * fold_m * float(i) / float(rings.size() - 1);
    for (int j = 0; j < kColumns; ++j) {
      const float turn = -2.F * kPi * float(j) / float(kColumns);
      const float wave = depth * std::cos(turn * float(folds));
      const Vector3f out((rings[i].half_x + wave) * std::cos(turn), 0.F, (rings[i].half_z + wave) * std::sin(turn));
      mesh.vertices.emplace_back(rings[i].centre + out);
    }
  }
  join_rings(mesh, base, int(rings.size()), kColumns, true, material);
  for (std::uint32_t j = 1; j + 1 < kColumns; ++j) add_triangle(mesh, base, base + j + 1, base + j, material);
}

void add_quad(SceneMesh& mesh, const Vector3f& a, const Vector3f& b, const Vector3f& c, const Vector3f& d,
              std::uint8_t material) {
  const std::uint32_t base = vertex_count(mesh);
  mesh.vertices.insert(mesh.vertices.end(), {a, b, c, d});
  add_triangle(mesh, base, base + 1, base + 2, material);
  add_triangle(mesh, base, base + 2, base + 3, material);
}

void add_curtain(SceneMesh& mesh, const Vector3f& left, const Vector3f& right, float drop_m, float fold_m, int folds,
                 std::uint8_t material) {
  constexpr int kStepsPerFold = 6;
  const std::uint32_t base = vertex_count(mesh);
  const Vector3f out = (right - left).cross(Vector3f::UnitY()).normalized();
  const int steps = folds * kStepsPerFold + 1;
  for (int end = 0; end < 2; ++end) {
    for (int j = 0; j < steps; ++j) {
      const float share = float(j) / float(steps - 1);
      const float wave = 0.5F * fold_m * std::sin(2.F * kPi * share * float(folds));
      mesh.vertices.emplace_back(left + share * (right - left) + wave * out -
                                 (end == 0 ? 0.F : drop_m) * Vector3f::UnitY());
    }
  }
  join_rings(mesh, base, 2, steps, false, material);
}

void move(SceneMesh& mesh, const Eigen::Isometry3f& motion) {
  for (Vector3f& p : mesh.vertices) p = motion * p;
}

}  // namespace vesalius::synth
