#pragma once

#include <Eigen/Geometry>
#include <functional>

#include "synth/scene/place_people.h"
#include "synth/scene/room.h"
#include "synth/scene/scene.h"
#include "synth/scene/scene_options.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// Returns an upright box in the room's frame that contains the camera, and people with their seats and beds.
using ExtentOf = std::function<Eigen::AlignedBox3f(const Eigen::Isometry3f& room_from_world)>;

/// Draws the room around everything that is placed, with some walls near and some far. `first` is the group of people
/// behind which a wall may be, or null.
RoomShape draw_room(const SceneOptions& options, const PlacedGroup* first, const ExtentOf& extent_of, Random& random);

/// Adds lamps below the ceiling and ambient light.
void add_lights(const RoomShape& room, Scene& scene, Random& random);

/// Draws the colour outside: more often day than night, and dim beyond a hall's edge.
Rgb draw_sky(const RoomShape& room, Random& random);

/// Makes whole pieces black leather or lacquer, of which depth cameras see only blotches or nothing. The first mesh is
/// the room.
void darken_furniture(float share, Scene& scene, Random& random);

}  // namespace vesalius::synth
