#pragma once

#include <span>

#include "synth/furniture/furniture.h"
#include "synth/furniture/seats.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

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
