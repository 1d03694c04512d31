#include "synth/furniture/nobody.h"

#include <array>
#include <cmath>

#include "synth/furniture/garments.h"
#include "synth/furniture/make_furniture.h"
#include "synth/furniture/seats.h"

namespace vesalius::synth {
namespace {

using Eigen::AngleAxisf;
using Eigen::Isometry3f;
using Eigen::Vector3f;

/// Adds a crumpled blanket: several flat cushions, one over the other, within the given half sizes. It is not solid.
void crumple_blanket(FurnitureBuilder& piece, const Vector3f& centre, const Vector3f& half, Random& random) {
  const std::uint8_t cloth = piece.stuff(Stuff::cloth);
  const int lumps = 4 + int(random.below(5));
  for (int i = 0; i < lumps; ++i) {
    const Vector3f aside{between(-0.6, 0.6, random), 0.F, between(-0.6, 0.6, random)};
    const Vector3f size{between(0.3, 0.6, random), between(0.4, 1.0, random), between(0.3, 0.6, random)};
    Isometry3f pose(Eigen::AngleAxisf(between(-0.3, 0.3, random), Vector3f::UnitZ()));
    pose.rotate(Eigen::AngleAxisf(between(-1.5, 1.5, random), Vector3f::UnitY()));
    pose.translation() = centre + half.cwiseProduct(aside);
    add_cushion(piece.piece.mesh, pose, half.cwiseProduct(size), cloth);
  }
}

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

/// Adds a chain of links, each turned against the one before, with a gripper of two fingers at its end. It stays above
/// the floor.
void add_arm(FurnitureBuilder& machine, const Vector3f& shoulder, Vector3f way, float radius, std::uint8_t shell,
             std::uint8_t joint, Random& random) {
  const int links = 2 + int(random.below(3));
  Vector3f from = shoulder;
  for (int i = 0; i < links; ++i) {
    const Vector3f bend{between(-0.8, 0.8, random), between(-0.8, 0.8, random), between(-0.3, 0.9, random)};
    if (i > 0) way = (way + bend).normalized();
    Vector3f to = from + between(0.12, 0.4, random) * way;
    to.y() = std::max(to.y(), 1.5F * radius);
    const float thinner = radius * between(0.7, 0.95, random);
    machine.cone(from, to, radius, thinner, shell);
    add_ellipsoid(machine.piece.mesh, placed_at(to), Vector3f::Constant(1.15F * thinner), joint, 6);
    radius = thinner;
    from = to;
  }
  const Vector3f side = way.unitOrthogonal();
  for (const float finger : {-1.F, 1.F}) {
    const Vector3f root = from + 0.6F * finger * radius * side;
    add_cone(machine.piece.mesh, root, root + between(0.05, 0.12, random) * way, 0.3F * radius, 0.2F * radius, joint,
             6);
  }
}

void add_head(FurnitureBuilder& machine, float height, std::uint8_t shell, std::uint8_t face, Random& random) {
  const float half = between(0.06, 0.14, random);
  const Vector3f centre(0.F, height + half, 0.02F);
  switch (random.below(3)) {
    case 0:
      add_ellipsoid(machine.piece.mesh, placed_at(centre), {half, 1.1F * half, half}, shell, 9);
      machine.solid(centre - Vector3f::Constant(0.8F * half), centre + Vector3f::Constant(0.8F * half));
      break;
    case 1:
      machine.box(centre - Vector3f(half, 0.7F * half, 0.6F * half), centre + Vector3f(half, 0.7F * half, 0.6F * half),
                  shell);
      break;
    default: {  // a screen
      Isometry3f pose = placed_at(centre);
      pose.linear() = Eigen::AngleAxisf(between(-0.7, 0.2, random), Vector3f::UnitX()).toRotationMatrix();
      machine.box(pose, {2.4F * half, 1.6F * half, 0.025F}, face);
    }
  }
}

/// Returns a robot or an upright machine, 0.4 to 1.9 m high: a base, a column, perhaps a trunk and a head, and up to
/// two arms of several links.
Furniture make_machine(Random& random) {
  FurnitureBuilder machine(random);
  const std::uint8_t shell = machine.stuff(chance(0.6, random) ? Stuff::plastic : Stuff::paint);
  const std::uint8_t dark = machine.stuff(Stuff::plastic), metal = machine.stuff(Stuff::metal);
  const float base = between(0.13, 0.32, random), base_height = between(0.08, 0.35, random);
  const float height = base_height + between(0.25, 1.2, random);
  const float column = between(0.04, 0.6 * base, random);
  if (chance(0.5, random)) {
    machine.post(0.F, 0.F, 0.F, base_height, base, dark);
  } else {
    machine.box({-base, 0.F, -base}, {base, base_height, base}, dark);
  }
  machine.cone({0.F, base_height, 0.F}, {0.F, height, 0.F}, column * between(1.0, 1.6, random), column, metal);
  float half_width = column;
  if (chance(0.65, random)) {
    half_width = between(0.1, 0.25, random);
    const float low = std::lerp(base_height, height, between(0.2, 0.6, random)), half = 0.5F * (height - low);
    const Vector3f size(half_width, half, half_width * between(0.5, 0.9, random)), middle(0.F, low + half, 0.F);
    if (chance(0.5, random)) {
      machine.box(middle - size, middle + size, shell);
    } else {
      add_cushion(machine.piece.mesh, placed_at(middle), size, shell);
      machine.solid(middle - 0.9F * size, middle + 0.9F * size);
    }
  }
  const std::uint32_t arms = random.below(3);
  for (std::uint32_t i = 0; i < arms; ++i) {
    const float side = i == 0 ? 1.F : -1.F;
    const Vector3f way =
        Vector3f{side * between(0.2, 1.0, random), between(-1.0, 0.6, random), between(0.0, 1.0, random)}.normalized();
    const Vector3f shoulder(side * half_width * 0.8F, height - 0.06F, 0.F);
    add_arm(machine, shoulder, way, between(0.03, 0.07, random), shell, dark, random);
  }
  machine.press_on_floor();
  if (chance(0.6, random)) add_head(machine, height, shell, dark, random);
  return std::move(machine.piece);
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
