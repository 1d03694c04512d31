#pragma once

#include <optional>

#include "synth/scene/furniture.h"
#include "synth/scene/occupancy.h"

namespace vesalius::synth {

/// Where a seat has to be for a sitting body. Seat frame: as that of make_seat(), standing on the floor.
struct SeatFit {
  Eigen::Isometry3f body_from_seat = Eigen::Isometry3f::Identity();
  float height_m = 0.F;
  float depth_m = 0.F;       ///< from the back to short of the calves
  float half_width_m = 0.F;  ///< of hips and thighs
  float back_m = 0.F;        ///< from the seat to the shoulders
  float lean_rad = 0.F;      ///< of the back, backwards
};

/// Nothing for somebody whose seat is the floor.
std::optional<SeatFit> fit_seat(const BodyMesh& mesh, const PosedBody& body);

/// Where a bed has to be for a lying body: as make_bed()'s frame, on the floor below it.
struct BedFit {
  Eigen::Isometry3f body_from_bed = Eigen::Isometry3f::Identity();
  float width_m = 0.F;  ///< of the body across the bed
  float length_m = 0.F;
};

BedFit fit_bed(const PosedBody& body);

/// A seat of a random kind under a sitting body (body frame) that it does not sink into; nothing after some tries.
std::optional<Furniture> make_fitting_seat(const SeatFit& fit, const BodyOutline& body, Random& random);

/// How far bodies sink into cushions and mattresses.
inline constexpr float kCushion_m = 0.012F;

}  // namespace vesalius::synth
