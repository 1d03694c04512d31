#include "synth/furniture/chairs.h"

#include <algorithm>
#include <array>

namespace vesalius::synth {
namespace {

using Eigen::AngleAxisf;
using Eigen::Isometry3f;
using Eigen::Translation3f;
using Eigen::Vector3f;

/// Adds the back of a chair in the frame of its foot: y runs up along it, z to the front. Cushions, nets in frames,
/// bent boards, slats.
void add_back_shape(FurnitureBuilder& chair, const Isometry3f& foot, float half, float tall, std::uint8_t frame,
                    std::uint8_t cover, Random& random) {
  SceneMesh& mesh = chair.piece.mesh;
  const auto at = [&](float x, float y, float z) -> Vector3f { return foot * Vector3f(x, y, z); };
  const float narrow = between(0.6, 1.0, random), bulge = between(0.0, 0.05, random);
  switch (random.below(4)) {
    case 0:
      add_cushion(mesh, foot * Translation3f(0.F, 0.5F * tall, 0.F), {half, 0.5F * tall, between(0.02, 0.06, random)},
                  cover);
      break;
    case 1: {  // a net in a frame
      const int strings = int(tall / 0.035F);
      for (int i = 0; i <= strings; ++i) {
        const float share = float(i) / float(strings), wide = half * std::lerp(1.F, narrow, share);
        const bool edge = i == 0 || i == strings;
        chair.thin(at(-wide, share * tall, bulge), at(wide, share * tall, bulge), edge ? 0.014F : 0.008F,
                   edge ? frame : cover);
      }
      for (const float side : {-half, half}) {
        chair.thin(at(side, 0.F, bulge), at(narrow * side, tall, bulge), 0.016F, frame);
      }
      break;
    }
    case 2:  // a board in three parts about the one who sits
      for (int i = -1; i <= 1; ++i) {
        Isometry3f part = foot * Translation3f(0.64F * half * float(i), 0.5F * tall, bulge * float(i * i));
        part.rotate(AngleAxisf(-float(i) * between(0.1, 0.5, random), Vector3f::UnitY()));
        add_box(mesh, part, {0.7F * half, tall, 0.02F}, cover);
      }
      break;
    default: {
      const bool upright = chance(0.5, random);
      const int slats = 2 + int(random.below(4));
      for (int i = 0; i < slats; ++i) {
        const float share = (float(i) + 0.5F) / float(slats);
        const Vector3f middle =
            upright ? Vector3f((2.F * share - 1.F) * half, 0.5F * tall, bulge) : Vector3f(0.F, share * tall, bulge);
        const Vector3f size = upright ? Vector3f(0.5F * half / float(slats), tall, 0.015F)
                                      : Vector3f(2.F * half, 0.45F * tall / float(slats), 0.015F);
        add_box(mesh, foot * Translation3f(middle), size, cover);
      }
      add_box(mesh, foot * Translation3f(0.F, tall, bulge), {2.F * half, 0.04F, 0.025F}, frame);
      for (const float side : {-half, half}) chair.thin(at(side, 0.F, 0.F), at(side, tall, bulge), 0.014F, frame);
    }
  }
  chair.piece.solids.push_back({foot * Translation3f(0.F, 0.5F * tall, 0.F), {half, 0.5F * tall, 0.04F}});
}

/// Adds arms at both sides of a seat, or none.
void add_arm_shape(FurnitureBuilder& chair, float half, float seat_m, std::uint8_t frame, std::uint8_t pad,
                   Random& random) {
  const std::uint32_t shape = random.below(5);
  const float rest = seat_m + between(0.15, 0.28, random), wide = between(0.02, 0.05, random);
  const float back = between(-0.2, -0.1, random), front = between(0.05, 0.2, random), turn = between(-0.2, 0.3, random);
  for (const float side : {-1.F, 1.F}) {
    const float x = side * (half + 0.04F), low = seat_m - 0.07F;
    if (shape > 3) return;
    chair.solid({x - 0.02F, low, -0.05F}, {x + 0.02F, rest, 0.05F});
    if (shape == 1) {  // a loop
      chair.thin({x, low, back}, {x, rest, back}, 0.014F, frame);
      chair.thin({x, rest, back}, {x, rest, front}, 0.018F, pad);
      chair.thin({x, rest, front}, {x, low, front}, 0.014F, frame);
      continue;
    }
    const Vector3f foot = shape == 0   ? Vector3f(x, low, 0.F)
                          : shape == 2 ? Vector3f(x, low, front + 0.04F)
                                       : Vector3f(x, rest - 0.02F, -half - 0.06F);
    chair.thin({0.7F * x, low, foot.z()}, {x, low, foot.z()}, 0.014F, frame);
    chair.thin(foot, {x, rest - 0.015F, 0.5F * (back + front)}, 0.018F, frame);
    Isometry3f top = placed_at({x, rest, 0.5F * (back + front)});
    top.rotate(AngleAxisf(-side * turn, Vector3f::UnitY()));
    add_box(chair.piece.mesh, top, {2.F * wide, 0.03F, front - back}, pad);
  }
}

/// Lays a piece on its back, its front or a side.
void lay_down(Furniture& piece, Random& random) {
  const float quarter = between(1.25, 1.6, random) * (chance(0.5, random) ? 1.F : -1.F);
  const Vector3f axis = chance(0.5, random) ? Vector3f::UnitX() : Vector3f::UnitZ();
  move(piece, Isometry3f(AngleAxisf(quarter, axis)));
  Eigen::AlignedBox3f bounds;
  for (const Vector3f& p : piece.mesh.vertices) bounds.extend(p);
  const Vector3f middle = bounds.center();
  move(piece, standing_at(-middle.x(), -bounds.min().y(), -middle.z(), 0.F));
}

/// Adds four legs that spread, a pair of runners, or a post on a disc, below a seat. Returns whether such chairs stack.
bool add_chair_base(FurnitureBuilder& chair, float half, float seat_m, std::uint8_t frame, Random& random) {
  const float spread = between(0.0, 0.06, random), thick = between(0.01, 0.02, random), rung = 0.35F * seat_m;
  const std::uint32_t base = random.below(4);
  if (base == 3) {
    chair.post(0.F, 0.F, 0.F, seat_m - 0.02F, 0.03F, frame);
    chair.post(0.F, 0.F, 0.F, 0.02F, between(0.18, 0.24, random), frame);
    return false;
  }
  const float in = half - 0.03F, out = half + spread;
  for (const float x : {-1.F, 1.F}) {
    for (const float z : {-1.F, 1.F}) {
      chair.rod({x * in, seat_m - 0.02F, z * in}, {x * out, thick, z * out}, thick, frame);
    }
    const float y = base == 2 ? thick : rung;
    chair.thin({x * out, y, -out}, {x * out, y, out}, thick, frame);
  }
  if (base == 1) {
    for (const float z : {-out, out}) chair.thin({-out, rung, z}, {out, rung, z}, thick, frame);
  }
  return true;
}

}  // namespace

Furniture make_swivel_chair(Random& random) {
  FurnitureBuilder chair(random);
  const std::uint8_t frame = chair.perhaps_black(chance(0.5, random) ? Stuff::metal : Stuff::plastic, 0.3);
  const std::uint8_t cover = chair.perhaps_black(chance(0.7, random) ? Stuff::cloth : Stuff::plastic, 0.25);
  const std::uint8_t seat = chair.perhaps_black(Stuff::cloth, 0.35);
  const bool high = chance(0.12, random);
  const float seat_m = high ? between(0.6, 0.8, random) : between(0.4, 0.56, random), half = between(0.2, 0.27, random);
  const float reach = between(0.25, 0.35, random), hub = between(0.09, 0.14, random);
  chair.star(5, reach, hub, frame);
  chair.post(0.F, 0.F, 0.08F, seat_m - 0.1F, between(0.02, 0.035, random), frame);
  add_box(chair.piece.mesh, Vector3f(-0.09F, seat_m - 0.14F, -0.14F), Vector3f(0.09F, seat_m - 0.07F, 0.12F), frame);
  const float thick = between(0.02, 0.05, random);
  add_cushion(chair.piece.mesh, placed_at({0.F, seat_m - thick, 0.F}), {half, thick, half * between(0.9, 1.1, random)},
              seat);
  chair.solid({-half, seat_m - 0.1F, -half}, {half, seat_m, half});
  if (high) chair.wheel({0.F, 0.25F, 0.F}, Vector3f::UnitY(), 0.2F, 0.02F, true, frame);  // a ring for the feet
  if (chance(0.9, random)) {
    const float gap = between(0.02, 0.2, random), tall = between(0.25, 0.7, random), lean = between(-0.05, 0.4, random);
    Isometry3f foot(AngleAxisf(-lean, Vector3f::UnitX()));
    foot.translation() = Vector3f(0.F, seat_m + gap, -half - 0.02F);
    chair.thin({0.F, seat_m - 0.1F, -0.6F * half}, foot * Vector3f(0.F, 0.4F * tall, -0.05F), 0.025F, frame);
    add_back_shape(chair, foot, half * between(0.8, 1.05, random), tall, frame, cover, random);
    if (chance(0.4, random)) {
      const float rise = tall + between(0.08, 0.16, random);
      chair.thin(foot * Vector3f(0.F, tall - 0.1F, -0.02F), foot * Vector3f(0.F, rise, 0.F), 0.012F, frame);
      const Vector3f size{between(0.09, 0.16, random), between(0.05, 0.09, random), between(0.02, 0.04, random)};
      add_cushion(chair.piece.mesh, foot * Translation3f(0.F, rise, 0.01F), size, cover);
    }
    add_arm_shape(chair, half, seat_m, frame, cover, random);
  }
  if (chance(0.1, random)) lay_down(chair.piece, random);
  return std::move(chair.piece);
}

Furniture make_plain_chair(Random& random) {
  FurnitureBuilder chair(random);
  constexpr std::array<Stuff, 3> kFrames = {Stuff::wood, Stuff::metal, Stuff::plastic};
  const std::uint8_t frame = chair.perhaps_black(kFrames[random.below(3)], 0.15);
  const std::uint8_t cover = chair.perhaps_black(chance(0.5, random) ? Stuff::wood : Stuff::cloth, 0.15);
  const bool bar = chance(0.35, random);
  const float seat_m = bar ? between(0.6, 0.82, random) : between(0.42, 0.5, random),
              half = between(0.16, 0.23, random);
  const bool stacks = add_chair_base(chair, half, seat_m, frame, random);
  const float thick = between(0.015, 0.04, random);
  if (chance(0.3, random)) {  // a round seat
    add_cone(chair.piece.mesh, {0.F, seat_m - thick, 0.F}, {0.F, seat_m, 0.F}, half, half, cover, 14);
  } else {
    add_box(chair.piece.mesh, Vector3f(-half, seat_m - thick, -half), Vector3f(half, seat_m, half), cover);
  }
  chair.solid({-half, seat_m - 0.08F, -half}, {half, seat_m, half});
  if (chance(bar ? 0.5 : 0.9, random)) {
    const float tall = bar ? between(0.15, 0.4, random) : between(0.3, 0.5, random);
    Isometry3f foot(AngleAxisf(-between(0.0, 0.3, random), Vector3f::UnitX()));
    foot.translation() = Vector3f(0.F, seat_m - 0.01F, -half + 0.01F);
    add_back_shape(chair, foot, 0.95F * half, tall, frame, cover, random);
  }
  const float fate = between(0.0, 1.0, random);
  if (fate < 0.1F) lay_down(chair.piece, random);
  if (stacks && fate > 0.9F) {
    Furniture above = chair.piece;
    const int more = 1 + int(random.below(3));
    for (int i = 0; i < more; ++i) {
      move(above, standing_at(0.F, between(0.06, 0.12, random), 0.02F, 0.F));
      join(chair.piece, above);
    }
  }
  return std::move(chair.piece);
}

}  // namespace vesalius::synth
