#pragma once

#include <vector>

#include "synth/mesh/oriented_box.h"
#include "synth/mesh/scene_mesh.h"

namespace vesalius::synth {

/// A piece of furniture in its own frame: metres, y up, standing on y = 0 about the origin, with its front towards +z.
struct Furniture {
  SceneMesh mesh;
  std::vector<OrientedBox> solids;  ///< bodies and other things must stay out of these; they hold most of the mesh
};

/// Moves a piece with its mesh and solids.
void move(Furniture& piece, const Eigen::Isometry3f& motion);

/// Returns a motion that turns by `yaw_rad` about y (positive is counter-clockwise when seen from above) and then moves
/// to (x, height, z).
Eigen::Isometry3f standing_at(float x_m, float height_m, float z_m, float yaw_rad);

}  // namespace vesalius::synth
