#include "synth/furniture/care.h"

#include <algorithm>
#include <cmath>

#include "synth/furniture/make_furniture.h"

namespace vesalius::synth {
namespace {

using Eigen::AngleAxisf;
using Eigen::Isometry3f;
using Eigen::Vector3f;

constexpr std::array<float, 2> kBothSides = {1.F, -1.F};  // left and right of who sits there

/// Adds a castor on the floor under a place, with the fork that holds it.
void add_castor(FurnitureBuilder& piece, float x, float z, float radius, float fork_m, std::uint8_t material,
                Random& random) {
  const float turn = between(-0.6, 0.6, random);
  piece.wheel({x, radius, z}, {std::cos(turn), 0.F, std::sin(turn)}, radius, 0.03F, false, material);
  piece.thin({x, radius, z}, {x, fork_m, z}, 0.012F, material);
}

/// Adds the rests of a wheelchair's feet, with the struts that hold them.
void add_footrests(FurnitureBuilder& chair, const SeatShape& shape, const std::array<Vector3f, 2>& soles,
                   std::uint8_t frame) {
  const Vector3f half(0.065F, 0.008F, 0.09F);
  for (std::size_t i = 0; i < soles.size(); ++i) {
    const Vector3f plate = soles[i] - Vector3f(0.F, half.y(), 0.F);
    chair.box(plate - half, plate + half, frame);
    const Vector3f knee(kBothSides[i] * 0.5F * shape.width_m, shape.height_m - 0.05F, shape.depth_m);
    chair.thin(knee, plate + Vector3f(kBothSides[i] * half.x(), 0.F, -0.6F * half.z()), 0.012F, frame);
  }
}

void add_wheelchair_arms(FurnitureBuilder& chair, const SeatShape& shape, std::uint8_t frame, std::uint8_t pad,
                         Random& random) {
  const float rest = shape.height_m + between(0.18, 0.25, random);
  const float front = std::min(shape.depth_m, between(0.28, 0.42, random));
  const bool panel = chance(0.5, random);
  for (const float side : kBothSides) {
    const float x = side * (0.5F * shape.width_m + 0.025F);
    chair.box({x - 0.025F, rest - 0.03F, 0.02F}, {x + 0.025F, rest, front}, pad);
    chair.thin({x, shape.height_m - 0.05F, front - 0.03F}, {x, rest - 0.02F, front - 0.03F}, 0.012F, frame);
    if (!panel) continue;
    add_box(chair.piece.mesh, Vector3f(x - 0.006F, shape.height_m, 0.02F),
            Vector3f(x + 0.006F, rest - 0.03F, front - 0.03F), pad);
  }
}

/// Adds bars from post to post along a bed's side.
void add_rail(FurnitureBuilder& bed, float x, float from_z, float to_z, float low, float high, std::uint8_t material,
              Random& random) {
  const int bars = 2 + int(random.below(3));
  for (int i = 0; i < bars; ++i) {
    const float y = std::lerp(low + 0.05F, high, float(i) / float(bars - 1));
    bed.thin({x, y, from_z}, {x, y, to_z}, 0.014F, material);
  }
  const int posts = 2 + int((to_z - from_z) / between(0.35, 0.8, random));
  for (int i = 0; i < posts; ++i) {
    const float z = std::lerp(from_z, to_z, float(i) / float(posts - 1));
    bed.thin({x, low - 0.1F, z}, {x, high, z}, 0.014F, material);
  }
  bed.solid({x - 0.015F, low, from_z}, {x + 0.015F, high, to_z});
}

/// Adds a column beside a bed with a board across it.
void add_bed_table(FurnitureBuilder& bed, float half_width, float height_m, std::uint8_t metal, Random& random) {
  const float z = between(-0.45, 0.1, random), top = height_m + between(0.28, 0.45, random);
  const float x = (half_width + 0.1F) * (chance(0.5, random) ? 1.F : -1.F);
  const std::uint8_t board = bed.stuff(Stuff::wood);
  bed.rod({x, 0.06F, z}, {x, top, z}, 0.03F, metal);
  bed.box({x - 0.03F, 0.F, z - 0.3F}, {x + 0.03F, 0.06F, z + 0.3F}, metal);
  const float inner = -0.4F * x;
  bed.box({std::min(x, inner), top, z - 0.2F}, {std::max(x, inner), top + 0.025F, z + 0.2F}, board);
}

/// Adds boxes, bottles and folded cloth on a board of a trolley.
void add_cargo(FurnitureBuilder& trolley, float half_x, float half_z, float board_m, Random& random) {
  FurnitureBuilder cargo(random);
  add_small_things(cargo, half_x, half_z, board_m, random);
  if (!cargo.piece.mesh.vertices.empty()) join(trolley.piece, cargo.piece);
}

/// Adds a sack in a ring, and perhaps mops beside it, as trolleys for linen and cleaning have.
void add_sack(FurnitureBuilder& trolley, float half_x, float top_m, std::uint8_t metal, Random& random) {
  const std::uint8_t cloth = trolley.stuff(Stuff::cloth);
  const float half = half_x * between(0.7, 0.95, random), deep = between(0.12, 0.2, random);
  const auto at = [&](float y, float wide) { return Ring{{0.F, y, 0.F}, wide * half, wide * deep}; };
  const float belly = between(0.95, 1.2, random), low = between(0.12, 0.25, random);
  const std::array<Ring, 4> rings = {at(top_m, 1.F), at(0.6F * top_m, 0.95F), at(low + 0.1F, belly), at(low, 0.8F)};
  add_garment(trolley.piece.mesh, rings, 3 + int(random.below(4)), 0.03F, cloth);
  trolley.solid({-0.9F * half, low, -0.9F * deep}, {0.9F * half, top_m, 0.9F * deep});
  const int sticks = int(random.below(3));
  for (int i = 0; i < sticks; ++i) {
    const Vector3f foot{between(-1.0, 1.0, random) * half, 0.3F, deep + 0.03F};
    trolley.thin(foot, foot + Vector3f{between(-0.1, 0.1, random), between(0.8, 1.2, random), 0.F}, 0.012F, metal);
  }
}

}  // namespace

Furniture make_wheelchair(const SeatShape& shape, const std::array<Vector3f, 2>& soles, Random& random) {
  FurnitureBuilder chair(random);
  const std::uint8_t frame = chair.stuff(chance(0.7, random) ? Stuff::metal : Stuff::paint);
  const std::uint8_t cover = chair.stuff(chance(0.5, random) ? Stuff::cloth : Stuff::plastic);
  const std::uint8_t tyre = chair.stuff(Stuff::plastic);
  const float half = 0.5F * shape.width_m, under = shape.height_m - 0.04F;
  add_seat_board(chair, shape, 0.04F, cover);
  add_seat_back(chair, shape, 0.95F * shape.width_m, 0.02F, 0.03F, cover);
  const Isometry3f on_back = seat_back_pose(shape, 0.03F, 0.F);
  const Vector3f up = 0.5F * shape.back_m * on_back.linear().col(1);
  const bool large = chance(0.75, random);  // else somebody else pushes it
  const float radius = large ? std::clamp(0.63F * shape.height_m, 0.16F, 0.31F) : between(0.09, 0.15, random);
  const float axle = between(0.0, 0.08, random);
  for (const float side : kBothSides) {
    const float x = side * (half + (large ? 0.055F : 0.02F));
    chair.wheel({x, radius, axle}, Vector3f::UnitX(), radius, 0.03F, chance(0.8, random), tyre);
    const Vector3f post(side * half, on_back.translation().y(), on_back.translation().z());
    chair.thin({side * half, radius, axle}, post - up, 0.013F, frame);
    chair.thin(post - up, post + up, 0.013F, frame);
    chair.thin(post + up, post + up - Vector3f(0.F, 0.F, 0.12F), 0.016F, tyre);
    chair.thin({side * half, under, 0.F}, {side * half, under, shape.depth_m}, 0.013F, frame);
    add_castor(chair, side * (half - 0.02F), shape.depth_m - 0.08F, between(0.05, 0.09, random), under, tyre, random);
  }
  chair.thin({-half, 0.2F, axle + 0.1F}, {half, under, axle + 0.1F}, 0.01F, frame);
  chair.thin({half, 0.2F, axle + 0.1F}, {-half, under, axle + 0.1F}, 0.01F, frame);
  add_footrests(chair, shape, soles, frame);
  if (chance(0.75, random)) add_wheelchair_arms(chair, shape, frame, cover, random);
  return std::move(chair.piece);
}

Furniture make_toilet(const SeatShape& shape, Random& random) {
  FurnitureBuilder toilet(random);
  const std::uint8_t china = toilet.stuff(Stuff::wall), lid = toilet.stuff(Stuff::plastic);
  const std::uint8_t metal = toilet.stuff(Stuff::metal);
  const float half = 0.19F, middle = 0.5F * shape.depth_m, deep = 0.5F * shape.depth_m;
  const float foot = chance(0.6, random) ? 0.F : 0.4F * shape.height_m;  // else it hangs at the wall
  const std::array<Ring, 3> bowl = {Ring{{0.F, shape.height_m - 0.03F, middle}, half, deep},
                                    Ring{{0.F, 0.6F * shape.height_m, middle - 0.02F}, 0.85F * half, 0.85F * deep},
                                    Ring{{0.F, foot, middle - 0.05F}, 0.6F * half, 0.55F * deep}};
  add_garment(toilet.piece.mesh, bowl, 0, 0.F, china);
  add_cushion(toilet.piece.mesh, placed_at({0.F, shape.height_m - 0.02F, middle}), {half, 0.02F, deep}, lid);
  toilet.solid({-half, 0.5F * shape.height_m, 0.F}, {half, shape.height_m, shape.depth_m});
  toilet.solid({-0.6F * half, foot, 0.F}, {0.6F * half, 0.5F * shape.height_m, 1.5F * middle});
  const float behind = -0.05F - 0.4F * std::sin(shape.lean_rad);
  if (foot == 0.F) {
    const float wide = between(0.17, 0.22, random), top = shape.height_m + between(0.3, 0.4, random);
    toilet.box({-wide, shape.height_m - 0.06F, behind - 0.17F}, {wide, top, behind}, china);
  } else {
    toilet.box({-0.3F, 0.F, behind - 0.1F}, {0.3F, between(1.0, 1.2, random), behind}, china);
    toilet.box({-0.6F * half, foot, behind}, {0.6F * half, shape.height_m - 0.06F, 0.02F}, china);
  }
  if (chance(0.6, random)) {
    SeatShape open = shape;
    open.lean_rad = std::max(0.1F, shape.lean_rad);
    open.back_m = 0.4F;
    add_box(toilet.piece.mesh, seat_back_pose(open, 0.02F, 0.F), {1.8F * half, 0.4F, 0.02F}, lid);
  }
  const float rail = between(0.3, 0.4, random), high = shape.height_m + between(0.2, 0.32, random);
  for (const float side : kBothSides) {
    if (chance(0.5, random)) continue;
    const Vector3f root(side * rail, high, behind), tip(side * rail, high, shape.depth_m + 0.1F);
    toilet.rod(root, tip, 0.016F, metal);
    toilet.thin(tip, tip - Vector3f(0.F, 0.15F, 0.F), 0.016F, metal);
    toilet.thin(tip - Vector3f(0.F, 0.15F, 0.F), root - Vector3f(0.F, 0.15F, 0.F), 0.016F, metal);
    toilet.box({side * rail - 0.03F, 0.F, behind - 0.03F}, {side * rail + 0.03F, high + 0.03F, behind}, metal);
  }
  return std::move(toilet.piece);
}

Furniture make_bench(const SeatShape& shape, Random& random) {
  FurnitureBuilder bench(random);
  const std::uint8_t wood = bench.stuff(chance(0.7, random) ? Stuff::wood : Stuff::plastic);
  const std::uint8_t frame = bench.stuff(chance(0.5, random) ? Stuff::metal : Stuff::wall);
  const float half = 0.5F * shape.width_m, thick = between(0.025, 0.05, random);
  const int slats = 1 + int(random.below(5));
  const float pitch = shape.depth_m / float(slats), gap = slats > 1 ? 0.012F : 0.F;
  for (int i = 0; i < slats; ++i) {
    add_box(bench.piece.mesh, Vector3f(-half, shape.height_m - thick, pitch * float(i)),
            Vector3f(half, shape.height_m, pitch * float(i + 1) - gap), wood);
  }
  solid_seat_board(bench, shape);
  const bool panels = chance(0.4, random);
  for (const float side : kBothSides) {
    const float x = side * half * between(0.75, 0.97, random), wide = panels ? 0.05F : 0.02F;
    const float clear = shape.height_m - thick;
    if (panels) {
      bench.box({x - wide, 0.F, 0.02F}, {x + wide, clear, shape.depth_m - 0.03F}, frame);
    } else {
      bench.box({x - wide, 0.F, 0.03F}, {x + wide, clear, 0.07F}, frame);
      bench.box({x - wide, 0.F, shape.depth_m - 0.08F}, {x + wide, clear, shape.depth_m - 0.04F}, frame);
    }
  }
  if (chance(0.6, random)) {
    const int boards = 1 + int(random.below(4));
    const float foot = 0.12F, step = (shape.back_m - foot) / float(boards);
    SeatShape part = shape;
    for (int i = 0; i < boards; ++i) {
      part.back_m = foot + step * float(i + 1);
      const float low = foot + step * float(i) + (boards > 1 ? 0.3F * step : 0.F);
      add_box(bench.piece.mesh, seat_back_pose(part, thick, low), {shape.width_m, part.back_m - low, thick}, wood);
    }
    solid_seat_back(bench, shape, shape.width_m, foot, thick);
    for (const float side : kBothSides) {
      Isometry3f post = seat_back_pose(shape, 0.04F, -0.05F);
      post.translation() += Vector3f(side * 0.8F * half, 0.F, -thick);
      add_box(bench.piece.mesh, post, {0.04F, shape.back_m + 0.05F, 0.03F}, frame);
    }
  }
  return std::move(bench.piece);
}

Furniture make_care_bed(float width_m, float length_m, float height_m, Random& random) {
  FurnitureBuilder bed(random);
  const std::uint8_t metal = bed.stuff(chance(0.5, random) ? Stuff::metal : Stuff::paint);
  const std::uint8_t board = bed.stuff(chance(0.6, random) ? Stuff::wood : Stuff::plastic);
  const std::uint8_t sheet = bed.stuff(Stuff::cloth), tyre = bed.stuff(Stuff::plastic);
  const float x = 0.5F * width_m, z = 0.5F * length_m, mattress = std::min(0.14F, 0.4F * height_m);
  const float under = height_m - mattress, deck = under - std::min(0.06F, 0.3F * under);
  bed.box({-x + 0.01F, under, -z + 0.01F}, {x - 0.01F, height_m, z - 0.01F}, sheet);
  bed.box({-x, deck, -z}, {x, under, z}, metal);
  const float wheel = std::min(0.07F, 0.3F * deck);
  for (const float end : {-0.8F, 0.8F}) {
    for (const float side : kBothSides) add_castor(bed, side * 0.8F * x, end * z, wheel, deck, tyre, random);
    bed.thin({-0.8F * x, 2.2F * wheel, end * z}, {0.8F * x, 2.2F * wheel, end * z}, 0.025F, metal);
  }
  const float top = height_m + between(0.2, 0.45, random);
  bed.box({-x, deck, z}, {x, top, z + 0.03F}, board);
  bed.box({-x, deck, -z - 0.03F}, {x, top - between(0.0, 0.15, random), -z}, board);
  const float rail_m = height_m + between(0.22, 0.4, random);
  const bool split = chance(0.4, random), lone = chance(0.25, random);
  for (const float side : kBothSides) {
    if (lone && side < 0.F) continue;
    const float out = side * (x + 0.03F);
    if (split) {
      add_rail(bed, out, -0.9F * z, -0.1F * z, height_m, rail_m, metal, random);
      add_rail(bed, out, 0.05F * z, 0.9F * z, height_m, rail_m, metal, random);
    } else {
      add_rail(bed, out, (chance(0.4, random) ? -0.2F : -0.9F) * z, 0.9F * z, height_m, rail_m, metal, random);
    }
  }
  if (chance(0.35, random)) {  // the pole by which somebody lifts themselves
    const float high = height_m + between(1.0, 1.3, random);
    const Vector3f foot(0.5F * x, deck, z + 0.06F), bend(0.5F * x, high, z + 0.06F), tip(0.2F * x, high, z - 0.6F);
    bed.rod(foot, bend, 0.02F, metal);
    bed.thin(bend, tip, 0.02F, metal);
    bed.thin(tip, tip - Vector3f(0.F, 0.45F, 0.F), 0.006F, metal);
    bed.thin(tip - Vector3f(0.1F, 0.45F, 0.F), tip + Vector3f(0.1F, -0.45F, 0.F), 0.014F, tyre);
  }
  if (chance(0.25, random)) add_bed_table(bed, x, height_m, metal, random);
  return std::move(bed.piece);
}

Furniture make_trolley(float handle_m, Random& random) {
  FurnitureBuilder trolley(random);
  const std::uint8_t metal = trolley.stuff(chance(0.6, random) ? Stuff::metal : Stuff::paint);
  const std::uint8_t body = trolley.stuff(chance(0.5, random) ? Stuff::plastic : Stuff::paint);
  const std::uint8_t tyre = trolley.stuff(Stuff::plastic);
  const float half_x = between(0.2, 0.35, random), half_z = between(0.22, 0.45, random);
  const float top = std::min(handle_m - 0.05F, between(0.6, 1.0, random)), clear = between(0.1, 0.2, random);
  for (const float x : {-half_x, half_x}) {
    for (const float z : {-half_z, half_z}) {
      add_castor(trolley, x, z, 0.4F * clear, clear, tyre, random);
    }
  }
  trolley.box({-half_x, clear - 0.02F, -half_z}, {half_x, clear, half_z}, body);
  switch (random.below(4)) {
    case 0:  // open shelves between posts
    {
      const int shelves = 1 + int(random.below(3));
      for (int i = 0; i < shelves; ++i) {
        const float y = std::lerp(clear, top, float(i + 1) / float(shelves));
        trolley.box({-half_x, y - 0.02F, -half_z}, {half_x, y, half_z}, body);
        add_cargo(trolley, 0.9F * half_x, 0.9F * half_z, y, random);
      }
      for (const float x : {-half_x, half_x}) {
        for (const float z : {-half_z, half_z}) trolley.thin({x, clear, z}, {x, top + 0.03F, z}, 0.014F, metal);
      }
      break;
    }
    case 1:  // drawers
      trolley.box({-half_x, clear, -half_z}, {half_x, top, half_z}, body);
      for (float y = clear + 0.1F; y < top - 0.05F; y += 0.14F) {
        add_box(trolley.piece.mesh, Vector3f(-0.9F * half_x, y, -half_z - 0.02F),
                Vector3f(0.9F * half_x, y + 0.015F, -half_z), metal);
      }
      add_cargo(trolley, 0.9F * half_x, 0.9F * half_z, top, random);
      break;
    case 2:
      for (const float x : {-half_x, half_x}) trolley.thin({x, clear, 0.F}, {x, top, 0.F}, 0.014F, metal);
      add_sack(trolley, half_x, top, metal, random);
      break;
    default: {  // boxes on a platform
      float low = clear;
      const int boxes = 1 + int(random.below(3));
      for (int i = 0; i < boxes; ++i) {
        const Vector3f half{half_x * between(0.6, 0.95, random), 0.F, half_z * between(0.6, 0.95, random)};
        const float high = low + between(0.15, 0.35, random);
        trolley.box({-half.x(), low, -half.z()}, {half.x(), high, half.z()}, trolley.stuff(Stuff::cardboard));
        low = high;
      }
    }
  }
  const float grip = -half_z - between(0.05, 0.15, random);
  for (const float x : {-half_x, half_x}) {
    trolley.thin({x, clear, -half_z}, {x, handle_m - 0.1F, -half_z}, 0.014F, metal);
    trolley.thin({x, handle_m - 0.1F, -half_z}, {x, handle_m, grip}, 0.014F, metal);
  }
  trolley.thin({-half_x, handle_m, grip}, {half_x, handle_m, grip}, 0.016F, tyre);
  move(trolley.piece, standing_at(0.F, 0.F, -grip, 0.F));
  return std::move(trolley.piece);
}

Furniture make_walker(float handle_m, Random& random) {
  FurnitureBuilder walker(random);
  const std::uint8_t metal = walker.stuff(chance(0.6, random) ? Stuff::metal : Stuff::paint);
  const std::uint8_t tyre = walker.stuff(Stuff::plastic), cloth = walker.stuff(Stuff::cloth);
  const bool rolls = chance(0.7, random);
  const float half = between(0.25, 0.31, random), radius = rolls ? between(0.07, 0.1, random) : 0.F;
  const float front = between(0.35, 0.5, random), hind = between(-0.2, -0.05, random), seat = 0.55F * handle_m;
  for (const float side : kBothSides) {
    const float x = side * half;
    walker.rod({x, radius, front}, {x, handle_m - 0.03F, 0.12F}, 0.014F, metal);
    walker.rod({x, radius, hind}, {x, 0.75F * handle_m, 0.18F}, 0.014F, metal);
    walker.thin({x, handle_m - 0.03F, 0.12F}, {x, handle_m, -0.04F}, 0.018F, tyre);
    walker.thin({x, 0.3F, 0.5F * (front + hind)}, {x, 0.3F, front - 0.06F}, 0.012F, metal);
    if (!rolls) continue;
    for (const float z : {front, hind}) walker.wheel({x, radius, z}, Vector3f::UnitX(), radius, 0.03F, false, tyre);
  }
  walker.thin({-half, seat, front - 0.1F}, {half, seat, front - 0.1F}, 0.012F, metal);
  walker.thin({-half, 0.3F, front - 0.06F}, {half, 0.3F, front - 0.06F}, 0.012F, metal);
  if (rolls) {
    walker.box({-half + 0.02F, seat - 0.03F, 0.1F}, {half - 0.02F, seat, 0.33F}, cloth);
    if (chance(0.6, random)) {  // a basket or bag in front
      walker.box({-0.75F * half, 0.3F, front - 0.12F}, {0.75F * half, seat + 0.05F, front + 0.08F}, cloth);
    }
    walker.thin({-half, 0.85F * handle_m, 0.17F}, {0.F, 0.83F * handle_m, 0.3F}, 0.02F, cloth);
    walker.thin({half, 0.85F * handle_m, 0.17F}, {0.F, 0.83F * handle_m, 0.3F}, 0.02F, cloth);
  }
  return std::move(walker.piece);
}

}  // namespace vesalius::synth
