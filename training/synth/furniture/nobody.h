#pragma once

#include <cstdint>

#include "synth/furniture/furniture.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// Things that a detector takes for people, or for parts of them.
enum class NobodyKind : std::uint8_t {
  wall_clothes,   ///< clothes on the hooks of a board; must stand at a wall
  clothes_rack,   ///< clothes on a rail that stands free
  office_chair,   ///< swivel chair with high back and arms, perhaps with a jacket
  jacket_chair,   ///< chair with a jacket over its back
  machine,        ///< robot: a base, a column, perhaps a head, and arms
  board,          ///< board that leans any way, on the floor or on a strut
  screens,        ///< table with tilted screens and small things
  bag,            ///< backpack, suitcase or sack
  cushions,       ///< heap of cushions and blankets on a sofa, a bed or the floor
  sleeping_place  ///< bed with a blanket that bulges as if somebody lay below it
};
inline constexpr int kNobodyKindCount = 10;

/// Returns whether a kind hangs on a wall.
inline bool hangs_on_wall(NobodyKind kind) { return kind == NobodyKind::wall_clothes; }

/// Returns a thing of random size and appearance.
Furniture make_nobody(NobodyKind kind, Random& random);

}  // namespace vesalius::synth
