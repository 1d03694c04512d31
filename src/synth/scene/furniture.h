#pragma once

#include <cstdint>
#include <vector>

#include "synth/scene/oriented_box.h"
#include "synth/scene/scene.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// A thing in a room. Its own frame: metres, y up, standing on y = 0 about the origin, its front towards +z.
struct Furniture {
  SceneMesh mesh;
  std::vector<OrientedBox> solids;  ///< what bodies and other things must keep out of; holds the mesh's bulk
};

/// Moves mesh and solids.
void move(Furniture& piece, const Eigen::Isometry3f& motion);

/// Turned by `yaw_rad` about y (positive: counter-clockwise seen from above) and put at (x, height, z).
Eigen::Isometry3f standing_at(float x_m, float height_m, float z_m, float yaw_rad);

enum class FurnitureKind : std::uint8_t {
  chair,
  stool,
  armchair,
  sofa,
  bed,
  table,
  desk,  ///< with monitor, and things on it
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

/// A piece of random size and look.
Furniture make_furniture(FurnitureKind kind, Random& random);

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

/// A seat whose back's foot is at z = 0 and whose front edge is at z = depth; x = 0 is its middle.
Furniture make_seat(const SeatShape& shape, Random& random);

/// A bed about the origin whose lying surface is at that height; its head end is at +z.
Furniture make_bed(float width_m, float length_m, float height_m, Random& random);

/// A table about the origin.
Furniture make_table(float width_m, float depth_m, float height_m, Random& random);

/// A piece made of a mesh of the user's: its bounding box is its solid.
Furniture as_furniture(SceneMesh mesh);

}  // namespace vesalius::synth
