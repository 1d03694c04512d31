#pragma once

#include <array>

#include "synth/furniture/furniture.h"
#include "synth/furniture/seats.h"

namespace vesalius::synth {

// Seats and beds of clinics, of homes where somebody is cared for, and of waiting rooms. Seats have the frame of
// make_seat(), beds that of make_bed().

/// Returns a wheelchair whose footrests end just below two soles, left and right.
Furniture make_wheelchair(const SeatShape& shape, const std::array<Eigen::Vector3f, 2>& soles, Random& random);

/// Returns a toilet, perhaps with a cistern, an open lid and grab rails.
Furniture make_toilet(const SeatShape& shape, Random& random);

/// Returns a bench of slats or boards, with or without a back.
Furniture make_bench(const SeatShape& shape, Random& random);

/// Returns a bed on castors with rails at its sides, perhaps with a lifting pole and a table across it.
Furniture make_care_bed(float width_m, float length_m, float height_m, Random& random);

// What people push. The piece's near side is at z = 0, where its handles are at the given height; it reaches to +z.

/// Returns a trolley: for serving, cleaning or linen, with drawers, or a platform with boxes.
Furniture make_trolley(float handle_m, Random& random);

/// Returns a walker with wheels, or a frame with four legs. Its hind legs stand beside the feet of who holds it.
Furniture make_walker(float handle_m, Random& random);

}  // namespace vesalius::synth
