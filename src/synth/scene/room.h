#pragma once

#include <Eigen/Geometry>

#include "synth/scene/scene.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// Floor plan: a rectangle of the room's own frame (y up, floor y = 0). Metres.
struct RoomShape {
  Eigen::Isometry3f world_from_room = Eigen::Isometry3f::Identity();  ///< a turn about y and a shift along the floor
  Eigen::Vector2f low = Eigen::Vector2f(-2.F, -2.F);                  ///< x and z of the walls
  Eigen::Vector2f high = Eigen::Vector2f(2.F, 2.F);
  float height_m = 2.5F;
  bool open = false;  ///< no walls, no ceiling: a floor without end
};

/// How far a point of the world is from the nearest wall, floor or ceiling of the room; negative beyond it.
float clearance(const RoomShape& room, const Eigen::Vector3f& point);

/// Floor, walls with doors, windows (holes: nothing behind them is seen) and curtains, skirting, ceiling; in world
/// coordinates.
SceneMesh make_room(const RoomShape& room, Random& random);

}  // namespace vesalius::synth
