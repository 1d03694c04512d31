#pragma once

#include <cstdint>

#include "synth/furniture/furniture.h"

namespace vesalius::synth {

/// Things on feet, rods and castors that a network takes for people or for their limbs, most of all far away, before a
/// low camera, or where a border cuts them. Some parts are black, so that depth cameras see holes there.
enum class GearKind : std::uint8_t {
  swivel_chair,     ///< five feet, arms and backs of several shapes; some lie on their side
  plain_chair,      ///< kitchen and bar chairs, with a back or without; some lie, some are stacked
  monitors,         ///< one to three screens on arms or stands, with cables; or one on a wheeled stand
  trolley,          ///< for serving, cleaning, linen or boxes
  walker,           ///< with wheels or four legs
  wheelchair,       ///< empty
  drip_stand,       ///< with bags and a pump
  dressed_machine,  ///< robot in a coat or dress
  coat_stand,       ///< coats on all sides, hats
  thin_thing        ///< lamp, ladder, open rack, high table, tripod or poles
};
inline constexpr int kGearKindCount = 10;

/// Returns a thing of random shape and appearance.
Furniture make_gear(GearKind kind, Random& random);

}  // namespace vesalius::synth
