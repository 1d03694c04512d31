#pragma once

#include <Eigen/Geometry>

#include "synth/scene/scene.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// The floor plan: a rectangle in the room's own frame (y up, floor at y = 0), in metres.
struct RoomShape {
  Eigen::Isometry3f world_from_room = Eigen::Isometry3f::Identity();  ///< turns about y and moves along the floor
  Eigen::Vector2f low = Eigen::Vector2f(-2.F, -2.F);                  ///< x and z of the walls
  Eigen::Vector2f high = Eigen::Vector2f(2.F, 2.F);
  float height_m = 2.5F;
  bool open = false;  ///< whether it is an endless floor without walls and ceiling
};

/// Returns the distance of a point of the world from the nearest wall, floor or ceiling of the room; it is negative
/// outside.
float clearance(const RoomShape& room, const Eigen::Vector3f& point);

/// Returns the floor, walls with doors, windows and curtains, skirting and ceiling, in world coordinates. Windows are
/// holes through which no surface is seen.
SceneMesh make_room(const RoomShape& room, Random& random);

}  // namespace vesalius::synth
