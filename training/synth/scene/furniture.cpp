#include "synth/scene/furniture.h"

#include "synth/scene/shapes.h"

namespace vesalius::synth {

using Eigen::Vector3f;

void move(Furniture& piece, const Eigen::Isometry3f& motion) {
  move(piece.mesh, motion);
  for (OrientedBox& box : piece.solids) box = moved(box, motion);
}

Eigen::Isometry3f standing_at(float x_m, float height_m, float z_m, float yaw_rad) {
  Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
  pose.linear() = Eigen::AngleAxisf(yaw_rad, Vector3f::UnitY()).toRotationMatrix();
  pose.translation() = Vector3f(x_m, height_m, z_m);
  return pose;
}

Furniture as_furniture(SceneMesh mesh) {
  Furniture piece;
  Eigen::AlignedBox3f bounds;
  for (const Vector3f& p : mesh.vertices) bounds.extend(p);
  if (!bounds.isEmpty()) {
    Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
    pose.translation() = bounds.center();
    piece.solids.push_back({pose, 0.5F * bounds.sizes()});
  }
  piece.mesh = std::move(mesh);
  return piece;
}

}  // namespace vesalius::synth
