#pragma once

#include <cstdint>

#include "synth/scene/furniture.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

enum class SeatKind : std::uint8_t { chair, stool, armchair, sofa };

/// What a seat must be to fit who sits on it.
struct SeatShape {
  SeatKind kind = SeatKind::chair;
  float height_m = 0.45F;  ///< of the seat above the floor
  float width_m = 0.45F;   ///< between the arms where there are any
  float depth_m = 0.45F;   ///< from the back's foot to the front edge
  float back_m = 0.45F;    ///< length of the back above the seat; none for stools
  float lean_rad = 0.1F;   ///< of the back, backwards
};

/// Returns a seat whose back's foot is at z = 0 and whose front edge is at z = depth; x = 0 is its middle.
Furniture make_seat(const SeatShape& shape, Random& random);

/// Returns a bed about the origin whose lying surface is at that height; its head end is at +z.
Furniture make_bed(float width_m, float length_m, float height_m, Random& random);

}  // namespace vesalius::synth
