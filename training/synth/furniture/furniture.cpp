#include "synth/furniture/furniture.h"

#include <cmath>
#include <numbers>

#include "synth/mesh/scene_mesh.h"

namespace vesalius::synth {

using Eigen::Vector3f;

void move(Furniture& piece, const Eigen::Isometry3f& motion) {
  move(piece.mesh, motion);
  for (OrientedBox& box : piece.solids) box = moved(box, motion);
}

void join(Furniture& piece, const Furniture& other) {
  SceneMesh& mesh = piece.mesh;
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const std::size_t looks = mesh.materials.size();
  mesh.vertices.insert(mesh.vertices.end(), other.mesh.vertices.begin(), other.mesh.vertices.end());
  mesh.materials.insert(mesh.materials.end(), other.mesh.materials.begin(), other.mesh.materials.end());
  for (const Triangle& t : other.mesh.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  for (const std::uint8_t look : other.mesh.material) mesh.material.push_back(static_cast<std::uint8_t>(looks + look));
  piece.solids.insert(piece.solids.end(), other.solids.begin(), other.solids.end());
}

Eigen::Isometry3f standing_at(float x_m, float height_m, float z_m, float yaw_rad) {
  Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
  pose.linear() = Eigen::AngleAxisf(yaw_rad, Vector3f::UnitY()).toRotationMatrix();
  pose.translation() = Vector3f(x_m, height_m, z_m);
  return pose;
}

void FurnitureBuilder::rod(const Vector3f& from, const Vector3f& to, float radius, std::uint8_t material) {
  thin(from, to, radius, material);
  Eigen::Isometry3f pose = placed_at(0.5F * (from + to));
  pose.rotate(Eigen::Quaternionf::FromTwoVectors(Vector3f::UnitY(), to - from));
  piece.solids.push_back({pose, {radius, 0.5F * (to - from).norm(), radius}});
}

void FurnitureBuilder::wheel(const Vector3f& centre, const Vector3f& axis, float radius, float width, bool spokes,
                             std::uint8_t material) {
  const Vector3f half_axis = 0.5F * width * axis.normalized();
  const Vector3f up = axis.unitOrthogonal().normalized(), ahead = axis.normalized().cross(up);
  if (spokes) {
    constexpr int kSections = 16;
    const auto at = [&](int i) -> Vector3f {
      const float turn = 2.F * std::numbers::pi_v<float> * float(i) / kSections;
      return centre + (radius - half_axis.norm()) * (std::cos(turn) * up + std::sin(turn) * ahead);
    };
    for (int i = 0; i < kSections; ++i) {
      add_cone(piece.mesh, at(i), at(i + 1), half_axis.norm(), half_axis.norm(), material, 5);
      if (i % 2 == 0) add_cone(piece.mesh, centre, at(i), 0.004F, 0.004F, material, 4);
    }
  } else {
    add_cone(piece.mesh, centre - half_axis, centre + half_axis, radius, radius, material, 12);
  }
  Eigen::Isometry3f pose = placed_at(centre);
  pose.linear() << up, axis.normalized(), up.cross(axis.normalized());
  piece.solids.push_back({pose, {0.8F * radius, half_axis.norm(), 0.8F * radius}});
}

std::uint8_t FurnitureBuilder::perhaps_black(Stuff kind, double probability) {
  Material look = sample_material(kind, random_);
  if (chance(probability, random_)) {
    look.colour = look.second = {22, 22, 24};
    look.infrared = between(0.002, 0.03, random_);
  }
  return add_material(piece.mesh, look);
}

void FurnitureBuilder::star(int feet, float reach, float hub_m, std::uint8_t material) {
  constexpr float kTurn = 2.F * std::numbers::pi_v<float>;
  const float first = between(0.0, kTurn, random_), castor = between(0.022, 0.035, random_);
  const float thick = between(0.014, 0.03, random_);
  for (int i = 0; i < feet; ++i) {
    const float turn = first + kTurn * float(i) / float(feet), swivel = between(0.0, kTurn, random_);
    const Vector3f tip(reach * std::cos(turn), 2.F * castor + 0.01F, reach * std::sin(turn));
    add_cone(piece.mesh, {0.F, hub_m, 0.F}, tip, 1.3F * thick, thick, material, 6);
    const Vector3f axis(0.014F * std::cos(swivel), 0.F, 0.014F * std::sin(swivel));
    const Vector3f middle(tip.x(), castor, tip.z());
    add_cone(piece.mesh, middle - axis, middle + axis, castor, castor, material, 8);
  }
  solid({-0.7F * reach, 0.F, -0.7F * reach}, {0.7F * reach, hub_m, 0.7F * reach});
}

}  // namespace vesalius::synth
