#include "synth/furniture/nobody.h"

#include <array>
#include <cmath>

#include "synth/furniture/cloth.h"
#include "synth/furniture/furniture_builder.h"
#include "synth/furniture/machine.h"
#include "synth/furniture/make_furniture.h"
#include "synth/furniture/seats.h"
#include "synth/furniture/small_things.h"

namespace vesalius::synth {
namespace {

using Eigen::AngleAxisf;
using Eigen::Isometry3f;
using Eigen::Vector3f;

FurnitureBuilder builder_of(Furniture piece, Random& random) {
  FurnitureBuilder builder(random);
  builder.piece = std::move(piece);
  return builder;
}

/// Hangs garments side by side below a rail from -half to half.
void hang_clothes(FurnitureBuilder& piece, float half, float height, float z, Random& random) {
  for (float x = -half; x < half;) {
    if (x == -half || chance(0.8, random)) {  // there is one at least
      hang_garment(piece, {x + 0.05F, height, z}, std::min(between(0.5, 1.2, random), height - 0.1F), random);
    }
    x += between(0.15, 0.45, random);
  }
}

Furniture make_wall_clothes(Random& random) {
  FurnitureBuilder hooks(random);
  const std::uint8_t wood = hooks.stuff(Stuff::wood);
  const float half = between(0.1, 0.6, random), height = between(1.3, 1.9, random);
  hooks.box({-half, height - 0.05F, -0.02F}, {half, height + 0.05F, 0.F}, wood);
  hang_clothes(hooks, half, height, 0.1F, random);
  return std::move(hooks.piece);
}

Furniture make_clothes_rack(Random& random) {
  FurnitureBuilder rack(random);
  const std::uint8_t metal = rack.stuff(Stuff::metal);
  const float half = between(0.3, 0.7, random), height = between(1.3, 1.75, random);
  for (const float x : {-half, half}) {
    rack.post(x, 0.F, 0.F, height, 0.015F, metal);
    rack.box({x - 0.02F, 0.F, -0.22F}, {x + 0.02F, 0.03F, 0.22F}, metal);
  }
  add_cone(rack.piece.mesh, {-half, height, 0.F}, {half, height, 0.F}, 0.012F, 0.012F, metal, 8);
  hang_clothes(rack, 0.85F * half, height, 0.F, random);
  return std::move(rack.piece);
}

Furniture make_office_chair(Random& random) {
  FurnitureBuilder chair(random);
  const std::uint8_t cover = chair.stuff(chance(0.6, random) ? Stuff::cloth : Stuff::plastic);
  const std::uint8_t frame = chair.stuff(chance(0.5, random) ? Stuff::plastic : Stuff::metal);
  const float seat = between(0.4, 0.55, random), half = between(0.2, 0.27, random), back = between(0.45, 0.8, random);
  for (int i = 0; i < 5; ++i) {
    const float turn = 1.2566F * float(i);
    add_cone(chair.piece.mesh, {0.F, 0.1F, 0.F}, {0.3F * std::cos(turn), 0.03F, 0.3F * std::sin(turn)}, 0.025F, 0.03F,
             frame, 6);
  }
  chair.solid({-0.2F, 0.F, -0.2F}, {0.2F, 0.1F, 0.2F});
  chair.post(0.F, 0.F, 0.1F, seat - 0.1F, 0.03F, frame);
  add_cushion(chair.piece.mesh, placed_at({0.F, seat - 0.06F, 0.F}), {half, 0.06F, half}, cover);
  chair.solid({-half, seat - 0.12F, -half}, {half, seat, half});
  Isometry3f pose(AngleAxisf(-between(0.0, 0.35, random), Vector3f::UnitX()));
  pose.translation() = Vector3f(0.F, seat + 0.06F, -half);
  const float wide = half * between(0.85, 1.05, random);
  const Vector3f back_half(wide, 0.5F * back, between(0.03, 0.06, random));
  Isometry3f middle = pose * Eigen::Translation3f(0.F, 0.5F * back, 0.F);
  add_cushion(chair.piece.mesh, middle, back_half, cover);
  chair.piece.solids.push_back({middle, back_half});
  if (chance(0.35, random)) {  // a headrest
    add_cushion(chair.piece.mesh, pose * Eigen::Translation3f(0.F, back + between(0.06, 0.14, random), 0.02F),
                {between(0.1, 0.15, random), 0.08F, 0.04F}, cover);
  }
  if (chance(0.7, random)) {
    const float rest = seat + between(0.16, 0.26, random);
    for (const float x : {-half - 0.04F, half + 0.04F}) {
      chair.box({x - 0.015F, seat - 0.08F, -0.03F}, {x + 0.015F, rest, 0.03F}, frame);
      chair.box({x - 0.04F, rest - 0.03F, -0.14F}, {x + 0.04F, rest, 0.14F}, frame);
    }
  }
  if (chance(0.5, random)) cover_chair_back(chair, pose * Vector3f(0.F, back, 0.F), 2.F * wide, random);
  return std::move(chair.piece);
}

Furniture make_jacket_chair(Random& random) {
  SeatShape shape;
  shape.height_m = between(0.4, 0.48, random);
  shape.width_m = between(0.38, 0.48, random);
  shape.depth_m = between(0.38, 0.46, random);
  shape.back_m = between(0.35, 0.6, random);
  shape.lean_rad = between(0.0, 0.2, random);
  FurnitureBuilder chair = builder_of(make_seat(shape, random), random);
  const Vector3f top(0.F, shape.height_m + shape.back_m * std::cos(shape.lean_rad),
                     -shape.back_m * std::sin(shape.lean_rad) - 0.02F);
  cover_chair_back(chair, top, shape.width_m, random);
  move(chair.piece, standing_at(0.F, 0.F, -0.2F, 0.F));
  return std::move(chair.piece);
}

Furniture make_board(Random& random) {
  FurnitureBuilder board(random);
  constexpr std::array<Stuff, 4> kStuff = {Stuff::wall, Stuff::wood, Stuff::cardboard, Stuff::plastic};
  const std::uint8_t surface = board.stuff(kStuff[random.below(4)]);
  const float width = between(0.25, 1.4, random), height = between(0.3, 1.6, random);
  Isometry3f pose(AngleAxisf(between(-0.7, 0.7, random), Vector3f::UnitX()));
  pose.rotate(AngleAxisf(between(-0.5, 0.5, random), Vector3f::UnitZ()));
  const Vector3f half(0.5F * width, 0.5F * height, between(0.006, 0.03, random));
  const float reach = pose.linear().row(1).cwiseAbs() * half;
  const float lift = chance(0.5, random) ? 0.F : between(0.1, 0.9, random);
  pose.translation().y() = reach + lift;
  board.box(pose, 2.F * half, surface);
  if (lift > 0.F) {
    const std::uint8_t metal = board.stuff(Stuff::metal);
    board.post(0.F, 0.F, 0.F, pose.translation().y(), between(0.015, 0.04, random), metal);
    board.post(0.F, 0.F, 0.F, 0.03F, between(0.12, 0.25, random), metal);
  }
  return std::move(board.piece);
}

Furniture make_screens(Random& random) {
  const float half_x = between(0.4, 0.9, random), half_z = between(0.3, 0.45, random);
  const float height = between(0.65, 1.0, random);
  FurnitureBuilder table = builder_of(make_table(2.F * half_x, 2.F * half_z, height, random), random);
  const std::uint8_t black = table.stuff(Stuff::plastic), glass = table.stuff(Stuff::glass);
  const int screens = 1 + int(random.below(3));
  for (int i = 0; i < screens; ++i) {
    const float x = half_x * (-0.7F + 1.4F * (float(i) + 0.5F) / float(screens));
    const float wide = between(0.3, 0.7, random), tall = wide * between(0.55, 0.8, random);
    Isometry3f pose(AngleAxisf(between(-3.2, 3.2, random), Vector3f::UnitY()));
    pose.rotate(AngleAxisf(between(-0.6, 0.3, random), Vector3f::UnitX()));
    pose.rotate(AngleAxisf(chance(0.3, random) ? between(-1.6, 1.6, random) : 0.F, Vector3f::UnitZ()));
    const Vector3f size{wide, tall, between(0.01, 0.06, random)};
    const float reach = 0.5F * pose.linear().row(1).cwiseAbs() * size;
    pose.translation() = Vector3f{x, height + reach + between(0.01, 0.2, random), between(-0.15, 0.1, random)};
    add_cone(table.piece.mesh, {x, height, pose.translation().z()}, pose.translation(), 0.04F, 0.025F, black, 8);
    table.box(pose, size, black);
    add_box(table.piece.mesh, pose * Eigen::Translation3f(0.F, 0.F, 0.5F * size.z()),
            {wide - 0.02F, tall - 0.02F, 0.003F}, glass);
  }
  add_small_things(table, half_x, half_z, height, random);
  return std::move(table.piece);
}

Furniture make_bag(Random& random) {
  FurnitureBuilder bag(random);
  const std::uint8_t cloth = bag.stuff(chance(0.6, random) ? Stuff::cloth : Stuff::plastic);
  const Vector3f half{between(0.13, 0.3, random), between(0.18, 0.4, random), between(0.08, 0.2, random)};
  const Vector3f middle(0.F, half.y(), 0.F);
  switch (random.below(3)) {
    case 0:  // backpack with a pocket
      add_cushion(bag.piece.mesh, placed_at(middle), half, cloth);
      add_cushion(bag.piece.mesh, placed_at({0.F, 0.7F * half.y(), half.z()}),
                  {0.7F * half.x(), 0.5F * half.y(), 0.05F}, cloth);
      bag.solid(middle - 0.85F * half, middle + 0.85F * half);
      break;
    case 1: {  // suitcase with its handle
      const float handle = 2.F * half.y() + between(0.05, 0.5, random);
      bag.box(middle - half, middle + half, cloth);
      for (const float x : {-0.5F, 0.5F}) {
        add_cone(bag.piece.mesh, {x * half.x(), half.y(), 0.F}, {x * half.x(), handle, 0.F}, 0.01F, 0.01F, cloth, 6);
      }
      add_cone(bag.piece.mesh, {-0.5F * half.x(), handle, 0.F}, {0.5F * half.x(), handle, 0.F}, 0.015F, 0.015F, cloth,
               6);
      break;
    }
    default: {  // sack, tied at the top
      const auto ring = [&](float y, float wide) {
        return Ring{{0.F, y * half.y(), 0.F}, wide * half.x(), wide * half.x()};
      };
      const std::array<Ring, 6> rings = {ring(2.F, 0.3F), ring(1.8F, 0.15F), ring(1.5F, 0.7F),
                                         ring(0.9F, 1.F), ring(0.3F, 0.95F), ring(0.F, 0.7F)};
      add_garment(bag.piece.mesh, rings, 5 + int(random.below(5)), 0.05F, cloth);
      bag.solid({-0.8F * half.x(), 0.F, -0.8F * half.x()}, {0.8F * half.x(), 1.7F * half.y(), 0.8F * half.x()});
    }
  }
  return std::move(bag.piece);
}

Furniture make_cushions(Random& random) {
  float ground = 0.F, half_x = between(0.3, 0.6, random), half_z = half_x;
  FurnitureBuilder heap(random);
  if (chance(0.6, random)) {
    SeatShape shape;
    shape.kind = chance(0.7, random) ? SeatKind::sofa : SeatKind::armchair;
    shape.height_m = between(0.38, 0.48, random);
    shape.width_m = shape.kind == SeatKind::sofa ? between(1.2, 2.1, random) : between(0.55, 0.7, random);
    shape.depth_m = between(0.45, 0.6, random);
    shape.lean_rad = between(0.05, 0.3, random);
    heap.piece = make_seat(shape, random);
    move(heap.piece, standing_at(0.F, 0.F, -0.25F, 0.F));
    ground = shape.height_m;
    half_x = 0.5F * shape.width_m;
    half_z = 0.2F;
  } else {
    heap.solid({-0.6F * half_x, 0.F, -0.6F * half_z}, {0.6F * half_x, 0.15F, 0.6F * half_z});
    add_cushion(heap.piece.mesh, placed_at({0.F, 0.09F, 0.F}), {0.9F * half_x, 0.09F, 0.9F * half_z},
                heap.stuff(Stuff::cloth));
  }
  const int cushions = 1 + int(random.below(6));
  for (int i = 0; i < cushions; ++i) {
    const Vector3f half{between(0.15, 0.28, random), between(0.13, 0.25, random), between(0.05, 0.1, random)};
    Isometry3f pose(AngleAxisf(between(-0.6, 0.6, random), Vector3f::UnitY()));
    pose.rotate(AngleAxisf(-between(0.0, 1.5, random), Vector3f::UnitX()));
    pose.rotate(AngleAxisf(between(-0.5, 0.5, random), Vector3f::UnitZ()));
    const float reach = 0.8F * pose.linear().row(1).cwiseAbs() * half;
    pose.translation() =
        Vector3f{between(-0.8, 0.8, random) * half_x, ground + reach, between(-0.8, 0.8, random) * half_z};
    add_cushion(heap.piece.mesh, pose, half, heap.stuff(Stuff::cloth));
  }
  if (chance(0.6, random)) {
    const Vector3f half{between(0.3, 0.5, random), between(0.08, 0.22, random), 0.3F};
    crumple_blanket(heap, {between(-0.4, 0.4, random) * half_x, ground + 0.4F * half.y(), 0.F}, half, random);
  }
  heap.press_on_floor();
  return std::move(heap.piece);
}

Furniture make_sleeping_place(Random& random) {
  const float width = between(0.8, 1.6, random), length = between(1.9, 2.1, random);
  const float height = between(0.25, 0.55, random);
  FurnitureBuilder bed = builder_of(make_bed(width, length, height, random), random);
  const std::uint8_t cloth = bed.stuff(Stuff::cloth);
  const float along = between(0.5, 0.9, random), thick = between(0.05, 0.15, random);
  const float x = between(-0.2, 0.2, random) * width;
  for (int i = 0; i < 5; ++i) {  // lumps in a row, as a rolled duvet
    const float share = float(i) / 4.F;
    const Vector3f middle{x + between(-0.08, 0.08, random), height, length * 0.45F * along * (1.F - 2.F * share)};
    const Vector3f half{between(0.15, 0.35, random), thick * between(0.7, 1.3, random), 0.22F * along * length};
    add_cushion(bed.piece.mesh, placed_at(middle), half, cloth);
  }
  return std::move(bed.piece);
}

}  // namespace

Furniture make_nobody(NobodyKind kind, Random& random) {
  switch (kind) {
    case NobodyKind::wall_clothes:
      return make_wall_clothes(random);
    case NobodyKind::clothes_rack:
      return make_clothes_rack(random);
    case NobodyKind::office_chair:
      return make_office_chair(random);
    case NobodyKind::jacket_chair:
      return make_jacket_chair(random);
    case NobodyKind::machine:
      return make_machine(random);
    case NobodyKind::board:
      return make_board(random);
    case NobodyKind::screens:
      return make_screens(random);
    case NobodyKind::bag:
      return make_bag(random);
    case NobodyKind::cushions:
      return make_cushions(random);
    case NobodyKind::sleeping_place:
      return make_sleeping_place(random);
  }
  return {};
}

}  // namespace vesalius::synth
