#pragma once

#include <cstdint>

#include "synth/furniture/furniture.h"
#include "vesalius/base/random.h"

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
inline constexpr int kFurnitureKindCount = 17;

/// Returns a piece of random size and appearance.
Furniture make_furniture(FurnitureKind kind, Random& random);

/// Returns a table centred on the origin.
Furniture make_table(float width_m, float depth_m, float height_m, Random& random);

}  // namespace vesalius::synth
