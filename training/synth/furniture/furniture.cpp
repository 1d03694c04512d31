#include "synth/furniture/furniture.h"

#include "synth/mesh/scene_mesh.h"

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

}  // namespace vesalius::synth
