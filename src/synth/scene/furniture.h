#pragma once

#include <vector>

#include "synth/scene/oriented_box.h"
#include "synth/scene/scene.h"

namespace vesalius::synth {

/// A thing in a room. Its own frame: metres, y up, standing on y = 0 about the origin, its front towards +z.
struct Furniture {
  SceneMesh mesh;
  std::vector<OrientedBox> solids;  ///< what bodies and other things must keep out of; holds the mesh's bulk
};

/// Moves mesh and solids.
void move(Furniture& piece, const Eigen::Isometry3f& motion);

/// Returns a motion that turns by `yaw_rad` about y (positive: counter-clockwise seen from above) and puts at (x,
/// height, z).
Eigen::Isometry3f standing_at(float x_m, float height_m, float z_m, float yaw_rad);

/// Returns a piece made of a mesh of the user's: its bounding box is its solid.
Furniture as_furniture(SceneMesh mesh);

}  // namespace vesalius::synth
