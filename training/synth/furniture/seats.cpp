#include "synth/furniture/seats.h"

#include <algorithm>
#include <cmath>

#include "synth/furniture/furniture_builder.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

/// Returns the frame of a back that stands on the seat's back edge and leans backwards from there.
Eigen::Isometry3f back_pose(const SeatShape& shape, float thickness, float foot) {
  Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
  pose.linear() = Eigen::AngleAxisf(-shape.lean_rad, Vector3f::UnitX()).toRotationMatrix();
  const float length = shape.back_m - foot;
  pose.translation() =
      Vector3f(0.F, shape.height_m, 0.F) + pose.linear() * Vector3f(0.F, foot + 0.5F * length, -0.5F * thickness);
  return pose;
}

/// Thickness of a board as a solid: boards are thin, but a body must not pass through.
constexpr float kSeatSolid_m = 0.08F;

void board(FurnitureBuilder& seat, const SeatShape& shape, float thickness, std::uint8_t material) {
  const float half = shape.width_m / 2;
  add_box(seat.piece.mesh, Vector3f(-half, shape.height_m - thickness, 0.F),
          Vector3f(half, shape.height_m, shape.depth_m), material);
  seat.solid({-half, shape.height_m - kSeatSolid_m, 0.F}, {half, shape.height_m, shape.depth_m});
}

void back(FurnitureBuilder& seat, const SeatShape& shape, float width, float foot, float thickness,
          std::uint8_t material) {
  add_box(seat.piece.mesh, back_pose(shape, thickness, foot), {width, shape.back_m - foot, thickness}, material);
  const float solid = std::max(thickness, kSeatSolid_m);
  seat.piece.solids.push_back({back_pose(shape, solid, foot), 0.5F * Vector3f(width, shape.back_m - foot, solid)});
}

void chair(const SeatShape& shape, FurnitureBuilder& seat, Random& random) {
  const std::uint8_t frame = seat.stuff(chance(0.6, random) ? Stuff::wood : Stuff::metal);
  const std::uint8_t cover = chance(0.5, random) ? frame : seat.stuff(Stuff::cloth);
  const float half = shape.width_m / 2, thick = between(0.02, 0.06, random), leg = between(0.025, 0.04, random);
  board(seat, shape, thick, cover);
  if (chance(0.75, random)) {
    seat.legs(half, 0.F, shape.depth_m, shape.height_m - thick, leg, frame);
  } else {  // the star of an office chair
    const float z = shape.depth_m / 2;
    seat.post(0.F, z, 0.06F, shape.height_m - thick, 0.03F, frame);
    seat.box({-half * 0.9F, 0.02F, z - 0.03F}, {half * 0.9F, 0.07F, z + 0.03F}, frame);
    seat.box({-0.03F, 0.02F, z - half * 0.9F}, {0.03F, 0.07F, z + half * 0.9F}, frame);
  }
  const float thickness = between(0.02, 0.06, random), foot = between(0.0, 0.5, random) * shape.back_m;
  back(seat, shape, shape.width_m * 0.95F, foot, thickness, cover);
  for (const float x : {-half * 0.8F, half * 0.8F}) {
    Eigen::Isometry3f pose = back_pose(shape, thickness, 0.F);
    pose.translation().x() = x;
    seat.box(pose, {leg, shape.back_m, 0.8F * thickness}, frame);
  }
}

void stool(const SeatShape& shape, FurnitureBuilder& seat, Random& random) {
  const std::uint8_t wood = seat.stuff(chance(0.6, random) ? Stuff::wood : Stuff::plastic);
  const float half = shape.width_m / 2, z = shape.depth_m / 2, thick = between(0.03, 0.07, random);
  board(seat, shape, thick, wood);
  if (chance(0.5, random)) {
    seat.legs(half * 0.9F, 0.05F * z, 1.95F * z, shape.height_m - thick, 0.03F, wood);
  } else {
    seat.post(0.F, z, 0.F, shape.height_m - thick, 0.04F, wood);
    seat.post(0.F, z, 0.F, 0.03F, 0.8F * std::min(half, z), wood);
  }
}

/// Makes an armchair or a sofa: a base, a thick back and arms at both sides.
void upholstered(const SeatShape& shape, FurnitureBuilder& seat, Random& random) {
  const std::uint8_t cloth = seat.stuff(Stuff::cloth), feet = seat.stuff(Stuff::wood);
  const float half = shape.width_m / 2, arm = between(0.1, 0.2, random), thickness = between(0.12, 0.22, random);
  const float clear = std::min(0.5F * shape.height_m, between(0.02, 0.12, random));
  const float back_end = -thickness - std::sin(shape.lean_rad) * 0.1F;
  seat.box({-half, clear, back_end}, {half, shape.height_m - 0.1F, shape.depth_m - 0.01F}, cloth);
  const int cushions = std::max(1, int(shape.width_m / 0.6F));
  const float wide = shape.width_m / float(cushions);
  for (int i = 0; i < cushions; ++i) {
    const float x = -half + wide * float(i);
    seat.box({x + 0.003F, shape.height_m - 0.1F, 0.F}, {x + wide - 0.003F, shape.height_m, shape.depth_m}, cloth);
  }
  seat.box(back_pose(shape, thickness, 0.F), {shape.width_m + 2.F * arm, shape.back_m, thickness}, cloth);
  const float arm_height = shape.height_m + between(0.12, 0.24, random);
  for (const float x : {-half - arm, half}) {
    seat.box({x, clear, back_end}, {x + arm, arm_height, shape.depth_m - 0.02F}, cloth);
  }
  seat.legs(half + arm, back_end, shape.depth_m, clear, 0.05F, feet);
}

}  // namespace

Furniture make_seat(const SeatShape& shape, Random& random) {
  FurnitureBuilder seat(random);
  switch (shape.kind) {
    case SeatKind::chair:
      chair(shape, seat, random);
      break;
    case SeatKind::stool:
      stool(shape, seat, random);
      break;
    case SeatKind::armchair:
    case SeatKind::sofa:
      upholstered(shape, seat, random);
      break;
  }
  return std::move(seat.piece);
}

Furniture make_bed(float width_m, float length_m, float height_m, Random& random) {
  FurnitureBuilder bed(random);
  const std::uint8_t wood = bed.stuff(Stuff::wood), sheet = bed.stuff(Stuff::cloth), pillow = bed.stuff(Stuff::cloth);
  const float x = width_m / 2, z = length_m / 2, mattress = std::min(0.2F, 0.5F * height_m);
  const float clear = std::min(0.1F, 0.3F * (height_m - mattress));
  bed.legs(x, -z, z, clear, 0.06F, wood);
  bed.box({-x, clear, -z}, {x, height_m - mattress, z}, wood);
  bed.box({-x + 0.01F, height_m - mattress, -z + 0.01F}, {x - 0.01F, height_m, z - 0.01F}, sheet);
  if (chance(0.7, random)) {
    const float top = height_m + between(0.1, 0.6, random);
    bed.box({-x, 0.F, z}, {x, top, z + between(0.03, 0.1, random)}, wood);
  }
  if (chance(0.3, random)) bed.box({-x, 0.F, -z - 0.04F}, {x, height_m + 0.1F, -z}, wood);
  if (chance(0.5, random)) {  // beside the place of the head; it is solid, so it is dropped if there is no room
    Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
    pose.translation() = Vector3f(0.F, height_m + 0.03F, z - 0.1F);
    const Vector3f half(std::min(0.3F, 0.8F * x), 0.06F, 0.12F);
    add_ellipsoid(bed.piece.mesh, pose, half, pillow, 8);
    bed.piece.solids.push_back({pose, 0.8F * half});
  }
  return std::move(bed.piece);
}

}  // namespace vesalius::synth
