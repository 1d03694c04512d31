#pragma once

#include <cstdint>
#include <span>

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

// The parts of seats, in the same frame.

/// Returns the frame of a back that stands on the seat's back edge, from `foot` up, and leans backwards from there. Its
/// origin is the middle of the back.
Eigen::Isometry3f seat_back_pose(const SeatShape& shape, float thickness, float foot);

/// Makes the seat, or the back, solid where nothing but slats or bars is to be seen.
void solid_seat_board(FurnitureBuilder& seat, const SeatShape& shape);
void solid_seat_back(FurnitureBuilder& seat, const SeatShape& shape, float width, float foot, float thickness);

/// Adds a flat seat, or a flat back, that is solid.
void add_seat_board(FurnitureBuilder& seat, const SeatShape& shape, float thickness, std::uint8_t material);
void add_seat_back(FurnitureBuilder& seat, const SeatShape& shape, float width, float foot, float thickness,
                   std::uint8_t material);

/// Returns a bed centred on the origin. Its surface is at the given height and its head end at +z.
Furniture make_bed(float width_m, float length_m, float height_m, Random& random);

// Cushions and blankets are no solids: bodies are in them.

/// Adds cushions to a sofa or an armchair in the frame of make_seat(), which rise `swell_m` above the seat and as far
/// from the back, so that a person who fits the seat sinks in. Some pillows lie about.
void add_seat_cushions(const SeatShape& shape, float swell_m, Furniture& seat, Random& random);

/// Adds a mattress to a bed in the frame of make_bed() that swells `swell_m` above its height.
void add_soft_mattress(float width_m, float length_m, float height_m, float swell_m, Furniture& bed, Random& random);

/// The ground and the extent of a blanket: x and z of its corners, and the height of what it lies on. Beyond `edge_z`
/// it hangs down to the floor.
struct BlanketPlace {
  Eigen::Vector2f low, high;
  float ground_m = 0.F;
  float edge_z = 1e3F;
  float top_m = 1e3F;  ///< points of the body above this are not below the blanket
};

/// Returns a blanket over points of a body, in whose frame y is up: 1 to 3 cm above what it covers, with some wrinkles.
SceneMesh drape_blanket(const BlanketPlace& place, std::span<const Eigen::Vector3f> body, Random& random);

}  // namespace vesalius::synth
