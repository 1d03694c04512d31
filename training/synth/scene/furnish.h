#pragma once

#include <vector>

#include "synth/furniture/furniture.h"
#include "synth/scene/occupancy.h"
#include "synth/scene/room.h"
#include "synth/scene/scene_options.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// Puts furniture into a room: along the walls, free-standing, and some of it between the camera and people. Adds it to
/// `occupancy`. Pieces that find no place are left out. People may be hidden in part, but not completely.
std::vector<Furniture> furnish(const SceneOptions& options, const RoomShape& room,
                               const std::vector<Eigen::Vector3f>& people, const Eigen::Vector3f& eye,
                               Occupancy& occupancy, Random& random);

}  // namespace vesalius::synth
