#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "synth/scene/place_people.h"
#include "synth/scene/scene_options.h"

namespace vesalius::synth {

/// Returns an upright box in the room's frame that contains the camera, and people with their seats and beds.
using ExtentOf = std::function<Eigen::AlignedBox3f(const Eigen::Isometry3f& room_from_world)>;

/// Draws the room around everything that is placed, with some walls near and some far. `first` is the group of people
/// behind which a wall may be, or null.
RoomShape draw_room(const SceneOptions& options, const PlacedGroup* first, const ExtentOf& extent_of, Random& random);

/// Adds furniture to a scene whose first mesh is the room: along the walls, free-standing, and some of it between the
/// camera and people; then lamps below the ceiling and what is seen outside. Pieces that find no place are left out;
/// the others are added to `occupancy` too. Some are black leather or lacquer, of which depth cameras see only
/// blotches. People may be hidden in part, but not completely.
void furnish(const SceneOptions& options, const RoomShape& room, const std::vector<Eigen::Vector3f>& people,
             const Eigen::Vector3f& eye, Occupancy& occupancy, Scene& scene, Random& random);

}  // namespace vesalius::synth
