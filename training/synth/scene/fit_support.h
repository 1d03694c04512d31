#pragma once

#include <array>
#include <optional>

#include "synth/furniture/furniture.h"
#include "synth/scene/occupancy.h"

namespace vesalius::synth {

/// The place of a seat for a sitting body. The seat frame is that of make_seat(), on the floor.
struct SeatFit {
  Eigen::Isometry3f body_from_seat = Eigen::Isometry3f::Identity();
  float height_m = 0.F;
  float depth_m = 0.F;                     ///< from the back to just before the calves
  float half_width_m = 0.F;                ///< half width of hips and thighs
  float back_m = 0.F;                      ///< from the seat to the shoulders
  float lean_rad = 0.F;                    ///< backward lean of the back
  std::array<Eigen::Vector3f, 2> soles{};  ///< middle of the left and right foot at its lowest, in the seat's frame
};

/// Returns nothing for a person who sits on the floor.
std::optional<SeatFit> fit_seat(const BodyMesh& mesh, const PosedBody& body);

/// The place of a bed for a lying body. The frame is that of make_bed(), on the floor below the body.
struct BedFit {
  Eigen::Isometry3f body_from_bed = Eigen::Isometry3f::Identity();
  float width_m = 0.F;  ///< width of the body across the bed
  float length_m = 0.F;
};

BedFit fit_bed(const PosedBody& body);

/// Makes a seat of a random kind under a sitting body (body frame) such that the body does not sink into it. Returns
/// nothing after some failed tries. With `swell_m` above 0 it is an armchair or a sofa if one fits, whose cushions
/// swell around the body.
std::optional<Furniture> make_fitting_seat(const SeatFit& fit, const BodyOutline& body, float swell_m, Random& random);

/// A seat that was made for somebody, and how much it lifts them.
struct CareSeat {
  Furniture seat;
  float lift_m = 0.F;
};

/// As make_fitting_seat(), but a wheelchair, a toilet or a bench. A wheelchair lifts the body, so that its feet are on
/// the rests; the seat is made for the lifted body. Returns nothing after some failed tries.
std::optional<CareSeat> make_care_seat(const SeatFit& fit, const BodyOutline& body, Random& random);

/// Returns the frame on the floor below the hips that is turned to the direction in which they face (+z).
Eigen::Isometry3f body_from_hips(const PosedBody& body);

/// Depth to which bodies sink into cushions and mattresses.
inline constexpr float kCushion_m = 0.012F;

}  // namespace vesalius::synth
