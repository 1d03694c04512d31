#pragma once

#include <cstdint>

#include "synth/furniture/furniture.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

enum class SeatKind : std::uint8_t { chair, stool, armchair, sofa };

/// The measures of a seat that fits a person.
struct SeatShape {
  SeatKind kind = SeatKind::chair;
  float height_m = 0.45F;  ///< height of the seat above the floor
  float width_m = 0.45F;   ///< width between the arms, if there are any
  float depth_m = 0.45F;   ///< length from the back to the front edge
  float back_m = 0.45F;    ///< length of the back above the seat; stools have none
  float lean_rad = 0.1F;   ///< backward lean of the back
};

/// Returns a seat. The foot of its back is at z = 0, its front edge at z = depth, and its middle at x = 0.
Furniture make_seat(const SeatShape& shape, Random& random);

/// Returns a bed centred on the origin. Its surface is at the given height and its head end at +z.
Furniture make_bed(float width_m, float length_m, float height_m, Random& random);

}  // namespace vesalius::synth
