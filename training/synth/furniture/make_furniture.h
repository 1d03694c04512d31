#pragma once

#include <cstdint>

#include "synth/furniture/furniture.h"

namespace vesalius::synth {

enum class FurnitureKind : std::uint8_t {
  chair,
  stool,
  armchair,
  sofa,
  bed,
  table,
  desk,  ///< with a monitor and other things on it
  shelf,
  wardrobe,
  lamp,
  plant,
  box,
  beanbag,
  pillar,
  coat_stand,  ///< resembles a person: a hanging coat, perhaps a hat
  mannequin,   ///< resembles a person: a torso on a pole
  panel        ///< door leaf, partition, board: upright or leaning
};

/// Returns a piece of random size and appearance.
Furniture make_furniture(FurnitureKind kind, Random& random);

/// Returns a table centred on the origin.
Furniture make_table(float width_m, float depth_m, float height_m, Random& random);

/// Adds small things to a top with the given half sides: cups, bottles, boxes and crumpled things. They are not solid.
void add_small_things(FurnitureBuilder& table, float half_x, float half_z, float height_m, Random& random);

/// Returns a desk behind which somebody sits towards +z, whose near edge is at z = 0: with screens that they look at,
/// some small things, and often a front. `height_m` is that of its top.
Furniture make_desk_before(float height_m, Random& random);

/// Returns a wall up to `height_m` with the opening of a door in it, perhaps with a frame. The opening begins at x = 0
/// and runs to +x; the wall before it is `width_m` wide, the one after it may be short or missing. The wall is about z
/// = 0.
Furniture make_doorway(float height_m, float width_m, Random& random);

/// Returns a closed counter, whose near side is at z = 0, with things on it.
Furniture make_counter(float height_m, Random& random);

}  // namespace vesalius::synth
