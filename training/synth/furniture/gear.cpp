#include "synth/furniture/gear.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "synth/furniture/care.h"
#include "synth/furniture/chairs.h"
#include "synth/furniture/garments.h"
#include "synth/furniture/make_furniture.h"
#include "synth/furniture/nobody.h"

namespace vesalius::synth {
namespace {

using Eigen::AngleAxisf;
using Eigen::Isometry3f;
using Eigen::Translation3f;
using Eigen::Vector3f;

constexpr float kCircle = 2.F * std::numbers::pi_v<float>;

/// Adds a rope or cable that sags between two points.
void add_cable(FurnitureBuilder& piece, const Vector3f& from, const Vector3f& to, float sag_m, std::uint8_t material) {
  constexpr int kSections = 6;
  const auto at = [&](int i) -> Vector3f {
    const float share = float(i) / kSections;
    return from + share * (to - from) - Vector3f(0.F, 4.F * sag_m * share * (1.F - share), 0.F);
  };
  for (int i = 0; i < kSections; ++i) {
    add_cone(piece.piece.mesh, at(i), at(i + 1), 0.005F, 0.005F, material, 4);
  }
}

/// Adds a black screen with its face to +z in the frame of its middle.
void add_screen(FurnitureBuilder& piece, const Isometry3f& middle, float wide, float tall, std::uint8_t shell,
                std::uint8_t glass) {
  piece.box(middle * Translation3f(0.F, 0.F, -0.015F), {wide, tall, 0.03F}, shell);
  add_box(piece.piece.mesh, middle, {wide - 0.01F, tall - 0.01F, 0.003F}, glass);
  add_box(piece.piece.mesh, middle * Translation3f(0.F, -0.1F * tall, -0.045F), {0.5F * wide, 0.5F * tall, 0.03F},
          shell);
}

/// Returns a screen on a pole with a star of feet, as in meeting rooms and wards.
Furniture make_screen_stand(Random& random) {
  FurnitureBuilder stand(random);
  const std::uint8_t frame = stand.perhaps_black(Stuff::metal, 0.3);
  const std::uint8_t shell = stand.perhaps_black(Stuff::plastic, 0.6), glass = stand.stuff(Stuff::glass);
  const float wide = between(0.35, 1.3, random), tall = wide * between(0.56, 0.65, random);
  const float middle = between(1.0, 1.55, random);
  const int feet = 4 + int(random.below(2));
  stand.star(feet, between(0.25, 0.4, random), 0.1F, frame);
  stand.post(0.F, -0.05F, 0.08F, middle, between(0.015, 0.035, random), frame);
  Isometry3f pose = placed_at({0.F, middle, 0.F});
  pose.rotate(AngleAxisf(-between(-0.1, 0.3, random), Vector3f::UnitX()));
  add_screen(stand, pose, wide, std::min(tall, 1.6F * (middle - 0.5F)), shell, glass);
  if (chance(0.5, random)) stand.box({-0.2F, 0.75F, -0.05F}, {0.2F, 0.78F, 0.2F}, frame);
  add_cable(stand, {0.05F, middle, -0.06F}, {0.1F, 0.12F, -0.1F}, 0.1F, shell);
  return std::move(stand.piece);
}

/// Returns a desk, low or at the height of who stands, with screens on arms or stands at its far edge.
Furniture make_monitors(Random& random) {
  if (chance(0.25, random)) return make_screen_stand(random);
  FurnitureBuilder desk(random);
  const float half_x = between(0.5, 0.9, random), half_z = between(0.3, 0.42, random);
  const float top = chance(0.35, random) ? between(0.95, 1.2, random) : between(0.65, 0.78, random);
  const std::uint8_t wood = desk.stuff(Stuff::wood), frame = desk.perhaps_black(Stuff::metal, 0.2);
  const std::uint8_t shell = desk.perhaps_black(Stuff::plastic, 0.7), glass = desk.stuff(Stuff::glass);
  desk.box({-half_x, top - 0.03F, -half_z}, {half_x, top, half_z}, wood);
  for (const float x : {-0.8F * half_x, 0.8F * half_x}) {
    desk.box({x - 0.04F, 0.F, -0.04F}, {x + 0.04F, top - 0.03F, 0.04F}, frame);
    desk.box({x - 0.04F, 0.F, -0.9F * half_z}, {x + 0.04F, 0.03F, 0.9F * half_z}, frame);
  }
  const int screens = 1 + int(random.below(3));
  const bool arms = chance(0.6, random);
  const float pole_x = between(-0.1, 0.1, random), back = -half_z + 0.05F, pole_m = top + between(0.25, 0.5, random);
  if (arms) desk.thin({pole_x, top, back}, {pole_x, pole_m, back}, 0.018F, frame);
  const float wide = between(0.4, 0.75, random), bend = between(0.0, 0.5, random);
  for (int i = 0; i < screens; ++i) {
    const float place = float(i) - 0.5F * float(screens - 1);
    const bool upright = chance(0.15, random);
    const float tall = wide * between(0.56, 0.65, random),
                x = place * std::min(wide + 0.03F, 1.9F * half_x / float(screens));
    Isometry3f pose(AngleAxisf(-bend * place + between(-0.15, 0.15, random), Vector3f::UnitY()));
    pose.rotate(AngleAxisf(-between(-0.1, 0.3, random), Vector3f::UnitX()));
    if (upright) pose.rotate(AngleAxisf(0.25F * kCircle, Vector3f::UnitZ()));
    const float reach = 0.5F * (upright ? wide : tall);
    const Vector3f lift{0.F, between(0.05, 0.2, random), between(0.0, 0.15, random)};
    pose.translation() = Vector3f(x, top + reach, back + 0.12F) + lift;
    add_screen(desk, pose, wide, tall, shell, glass);
    const Vector3f rear = pose * Vector3f(0.F, 0.F, -0.06F);
    if (arms) {
      const Vector3f shoulder(pole_x, std::min(rear.y(), pole_m), back);
      const Vector3f elbow = 0.5F * (shoulder + rear) - Vector3f(0.F, 0.F, between(0.02, 0.18, random));
      desk.thin(shoulder, elbow, 0.02F, frame);
      desk.thin(elbow, rear, 0.017F, frame);
    } else {
      desk.thin({x, top, rear.z()}, rear, 0.022F, frame);
      add_box(desk.piece.mesh, Vector3f(x - 0.12F, top, rear.z() - 0.08F),
              Vector3f(x + 0.12F, top + 0.012F, rear.z() + 0.1F), frame);
    }
    const Vector3f plug{x + between(-0.2, 0.2, random), between(0.1, 0.5, random), back - 0.06F};
    add_cable(desk, rear, {plug.x(), top, back - 0.06F}, 0.08F, shell);
    add_cable(desk, {plug.x(), top, back - 0.06F}, plug, 0.03F, shell);
  }
  add_small_things(desk, half_x, 0.6F * half_z, top, random);
  return std::move(desk.piece);
}

Furniture make_empty_wheelchair(Random& random) {
  SeatShape shape;
  shape.height_m = between(0.44, 0.54, random);
  shape.width_m = between(0.38, 0.5, random);
  shape.depth_m = between(0.38, 0.45, random);
  shape.back_m = between(0.35, 0.5, random);
  shape.lean_rad = between(0.05, 0.25, random);
  const float low = between(0.08, 0.16, random), ahead = shape.depth_m + between(0.08, 0.2, random);
  Furniture chair = make_wheelchair(shape, {Vector3f(0.1F, low, ahead), Vector3f(-0.1F, low, ahead)}, random);
  move(chair, standing_at(0.F, 0.F, -0.25F, 0.F));
  return chair;
}

/// Returns a trolley or walker about the origin instead of before who pushes it.
Furniture centred(Furniture (*make)(float handle_m, Random& random), Random& random) {
  Furniture piece = make(between(0.85, 1.05, random), random);
  move(piece, standing_at(0.F, 0.F, -0.3F, 0.F));
  return piece;
}

Furniture make_drip_stand(Random& random) {
  FurnitureBuilder stand(random);
  const std::uint8_t metal = stand.stuff(Stuff::metal), bag = stand.stuff(Stuff::plastic);
  const std::uint8_t pump = stand.perhaps_black(Stuff::plastic, 0.2);
  const float top = between(1.5, 2.1, random);
  const int feet = 4 + int(random.below(2));
  stand.star(feet, between(0.2, 0.3, random), 0.09F, metal);
  stand.post(0.F, 0.F, 0.08F, top, between(0.01, 0.018, random), metal);
  const int hooks = 2 + 2 * int(random.below(2));
  for (int i = 0; i < hooks; ++i) {
    const float turn = kCircle * float(i) / float(hooks);
    const Vector3f tip(0.12F * std::cos(turn), top + 0.04F, 0.12F * std::sin(turn));
    stand.thin({0.F, top, 0.F}, tip, 0.006F, metal);
    if (!chance(0.5, random)) continue;
    const Vector3f half{between(0.045, 0.07, random), between(0.09, 0.14, random), 0.02F};
    add_cushion(stand.piece.mesh, placed_at(tip - Vector3f(0.F, half.y() + 0.03F, 0.F)), half, bag);
    add_cable(stand, tip - Vector3f(0.F, 2.F * half.y(), 0.F), {0.05F, 0.9F, 0.05F}, 0.05F, bag);
  }
  const int pumps = int(random.below(3));
  for (int i = 0; i < pumps; ++i) {
    const float y = 1.F + 0.22F * float(i);
    stand.box({-0.1F, y, 0.F}, {0.1F, y + 0.16F, 0.14F}, pump);
  }
  if (chance(0.4, random)) stand.thin({-0.15F, 1.F, 0.02F}, {0.15F, 1.F, 0.02F}, 0.012F, metal);
  return std::move(stand.piece);
}

/// Returns half the width, the top, and half the depth of what a machine has about its axis, without arms and base.
Vector3f trunk_of(const Furniture& machine) {
  constexpr float kAside_m = 0.06F, kLow_m = 0.35F;
  Vector3f trunk(0.1F, 0.F, 0.08F);
  for (const OrientedBox& box : machine.solids) {
    const Vector3f& middle = box.pose.translation();
    if (std::hypot(middle.x(), middle.z()) > kAside_m) continue;
    const Vector3f half = box.pose.linear().cwiseAbs() * box.half;
    trunk.y() = std::max(trunk.y(), middle.y() + half.y());
    if (middle.y() < kLow_m) continue;
    trunk.x() = std::max(trunk.x(), half.x());
    trunk.z() = std::max(trunk.z(), half.z());
  }
  return trunk;
}

Furniture make_dressed_machine(Random& random) {
  constexpr int kTries = 5;
  constexpr float kHuman_m = 0.9F;
  FurnitureBuilder machine(random);
  Vector3f trunk = Vector3f::Zero();
  for (int i = 0; i < kTries && trunk.y() < kHuman_m; ++i) {
    machine.piece = make_nobody(NobodyKind::machine, random);
    trunk = trunk_of(machine.piece);
  }
  const std::uint8_t cloth = machine.stuff(Stuff::cloth);
  const float collar = trunk.y() - between(0.0, 0.25, random), hem = collar * between(0.15, 0.6, random);
  const float wide = trunk.x() + between(0.02, 0.06, random), deep = trunk.z() + between(0.02, 0.05, random);
  const float flare = between(0.9, 1.5, random), shoulder = collar - 0.08F;
  const std::array<Ring, 4> rings = {
      Ring{{0.F, collar, 0.F}, 0.6F * wide, 0.7F * deep}, Ring{{0.F, shoulder, 0.F}, wide, deep},
      Ring{{0.F, 0.5F * (shoulder + hem), 0.F}, std::max(1.F, 0.5F * (1.F + flare)) * wide, 1.05F * deep},
      Ring{{0.F, hem, 0.F}, std::max(1.F, flare) * wide, std::max(1.F, flare) * deep}};
  add_garment(machine.piece.mesh, rings, 4 + int(random.below(6)), between(0.01, 0.05, random), cloth);
  if (chance(0.6, random)) {
    for (const float side : {-1.F, 1.F}) {
      hang_sleeve(machine, {side * 0.9F * wide, shoulder - 0.02F, 0.F}, side, cloth, random);
    }
  }
  if (chance(0.3, random)) {
    const std::uint8_t felt = machine.stuff(Stuff::cloth);
    machine.cone({0.F, trunk.y() - 0.03F, 0.F}, {0.F, trunk.y() + 0.08F, 0.F}, between(0.1, 0.17, random), 0.08F, felt);
  }
  machine.press_on_floor();
  return std::move(machine.piece);
}

Furniture make_full_coat_stand(Random& random) {
  FurnitureBuilder stand(random);
  const std::uint8_t wood = stand.stuff(chance(0.5, random) ? Stuff::wood : Stuff::metal);
  const float height = between(1.45, 1.95, random);
  stand.post(0.F, 0.F, 0.F, height, between(0.015, 0.03, random), wood);
  const float reach = between(0.18, 0.28, random);
  for (int i = 0; i < 4; ++i) {
    const float turn = kCircle * float(i) / 4.F;
    stand.thin({0.F, 0.12F, 0.F}, {reach * std::cos(turn), 0.015F, reach * std::sin(turn)}, 0.015F, wood);
  }
  stand.solid({-0.7F * reach, 0.F, -0.7F * reach}, {0.7F * reach, 0.1F, 0.7F * reach});
  const int hooks = 3 + int(random.below(4));
  for (int i = 0; i < hooks; ++i) {
    const float turn = kCircle * float(i) / float(hooks), low = height - between(0.05, 0.2, random);
    const Isometry3f hook = standing_at(0.F, low, 0.F, turn);
    stand.thin({0.F, low - 0.06F, 0.F}, hook * Vector3f(0.F, 0.03F, 0.12F), 0.008F, wood);
    if (!chance(0.55, random)) continue;
    FurnitureBuilder coat(random);
    hang_garment(coat, {0.F, 0.F, 0.1F}, std::min(low - 0.1F, between(0.55, 1.15, random)), random);
    move(coat.piece, hook);
    join(stand.piece, coat.piece);
  }
  if (chance(0.5, random)) {
    const std::uint8_t felt = stand.stuff(Stuff::cloth);
    const Vector3f crown{between(0.08, 0.11, random), between(0.06, 0.1, random), between(0.09, 0.12, random)};
    add_ellipsoid(stand.piece.mesh, placed_at({0.F, height + 0.03F, 0.F}), crown, felt, 8);
    if (chance(0.5, random)) {
      add_cone(stand.piece.mesh, {0.F, height, 0.F}, {0.F, height + 0.01F, 0.F}, 0.17F, 0.16F, felt, 14);
    }
  }
  return std::move(stand.piece);
}

Furniture make_ladder(Random& random) {
  FurnitureBuilder ladder(random);
  const std::uint8_t metal = ladder.stuff(chance(0.7, random) ? Stuff::metal : Stuff::wood);
  const float height = between(0.9, 2.0, random), half = between(0.18, 0.24, random), spread = 0.28F * height;
  const float radius = between(0.015, 0.025, random);
  for (const float end : {-spread, spread}) {
    for (const float x : {-half, half}) ladder.rod({x, radius, end}, {0.8F * x, height, 0.F}, radius, metal);
  }
  for (float share = 0.12F; share < 0.95F; share += 0.26F / height) {
    const float x = half * std::lerp(1.F, 0.8F, share), z = spread * (1.F - share);
    add_box(ladder.piece.mesh, Vector3f(-x, share * height - 0.01F, z - 0.04F),
            Vector3f(x, share * height + 0.01F, z + 0.04F), metal);
  }
  ladder.thin({-0.9F * half, 0.5F * height, -0.5F * spread}, {0.9F * half, 0.5F * height, -0.5F * spread}, 0.01F,
              metal);
  return std::move(ladder.piece);
}

Furniture make_bent_lamp(Random& random) {
  FurnitureBuilder lamp(random);
  const std::uint8_t metal = lamp.perhaps_black(Stuff::metal, 0.2), shade = lamp.stuff(Stuff::cloth);
  const float height = between(1.1, 1.9, random);
  lamp.post(0.F, 0.F, 0.F, 0.025F, between(0.1, 0.18, random), metal);
  lamp.post(0.F, 0.F, 0.F, height, between(0.01, 0.025, random), metal);
  const int arms = 1 + int(random.below(3));
  for (int i = 0; i < arms; ++i) {
    const float turn = between(0.0, kCircle, random), out = between(0.1, 0.45, random);
    const Vector3f root(0.F, height - between(0.0, 0.5, random), 0.F);
    const Vector3f tip = root + Vector3f{out * std::cos(turn), between(-0.1, 0.2, random), out * std::sin(turn)};
    lamp.rod(root, tip, 0.01F, metal);
    const Vector3f way{between(-0.5, 0.5, random), between(-1.0, 0.3, random), between(-0.5, 0.5, random)};
    const float wide = between(0.06, 0.15, random);
    add_cone(lamp.piece.mesh, tip, tip + 1.5F * wide * way.normalized(), 0.3F * wide, wide, shade, 10);
  }
  return std::move(lamp.piece);
}

/// Returns a rack of thin posts and boards with few things, or a high table.
Furniture make_open_rack(Random& random) {
  FurnitureBuilder rack(random);
  const bool table = chance(0.4, random);
  const std::uint8_t frame = rack.perhaps_black(chance(0.6, random) ? Stuff::metal : Stuff::wood, 0.2);
  const std::uint8_t board = rack.stuff(Stuff::wood);
  const float half_x = between(0.25, 0.7, random),
              half_z = table ? between(0.25, 0.4, random) : between(0.15, 0.25, random);
  const float height = table ? between(0.7, 1.15, random) : between(1.0, 2.1, random),
              post = between(0.01, 0.04, random);
  for (const float x : {-half_x + post, half_x - post}) {
    for (const float z : {-half_z + post, half_z - post}) rack.post(x, z, 0.F, height, post, frame);
  }
  const int boards = table ? 1 : 2 + int(random.below(4));
  for (int i = 0; i < boards; ++i) {
    const float y = boards == 1 ? height : std::lerp(between(0.08, 0.3, random), height, float(i) / float(boards - 1));
    rack.box({-half_x, y - 0.02F, -half_z}, {half_x, y, half_z}, board);
    if (chance(0.4, random)) add_small_things(rack, 0.9F * half_x, 0.8F * half_z, y, random);
  }
  return std::move(rack.piece);
}

/// Returns a stand on three legs with a camera, a lamp or a board.
Furniture make_tripod(Random& random) {
  FurnitureBuilder tripod(random);
  const std::uint8_t metal = tripod.perhaps_black(Stuff::metal, 0.3), load = tripod.perhaps_black(Stuff::plastic, 0.3);
  const float head = between(0.8, 1.7, random), reach = between(0.25, 0.5, random),
              hub = head * between(0.5, 0.85, random);
  const float thick = between(0.01, 0.02, random);
  for (int i = 0; i < 3; ++i) {
    const float turn = kCircle * float(i) / 3.F;
    tripod.rod({0.F, hub, 0.F}, {reach * std::cos(turn), thick, reach * std::sin(turn)}, thick, metal);
  }
  tripod.post(0.F, 0.F, 0.5F * hub, head, 0.8F * thick, metal);
  Isometry3f pose = placed_at({0.F, head, 0.F});
  pose.rotate(AngleAxisf(between(-0.5, 0.5, random), Vector3f::UnitX()));
  const Vector3f size =
      chance(0.5, random) ? Vector3f{between(0.1, 0.2, random), between(0.08, 0.15, random), between(0.1, 0.25, random)}
                          : Vector3f{between(0.3, 0.7, random), between(0.3, 0.9, random), 0.015F};
  tripod.box(pose, size, load);
  return std::move(tripod.piece);
}

/// Returns one to three poles, perhaps with a belt or a rope from each to the next.
Furniture make_poles(Random& random) {
  FurnitureBuilder poles(random);
  const std::uint8_t metal = poles.perhaps_black(chance(0.5, random) ? Stuff::metal : Stuff::paint, 0.2);
  const int count = 1 + int(random.below(3));
  const float height = between(0.9, 2.2, random), radius = between(0.015, 0.06, random),
              apart = between(0.15, 0.6, random);
  const bool rope = chance(0.5, random);
  for (int i = 0; i < count; ++i) {
    const float x = apart * (float(i) - 0.5F * float(count - 1));
    poles.post(x, 0.F, 0.F, height, radius, metal);
    if (radius < 0.04F) poles.post(x, 0.F, 0.F, 0.02F, between(0.1, 0.17, random), metal);
    if (rope && i > 0) add_cable(poles, {x - apart, 0.95F * height, 0.F}, {x, 0.95F * height, 0.F}, 0.08F, metal);
  }
  return std::move(poles.piece);
}

Furniture make_thin_thing(Random& random) {
  constexpr std::array<Furniture (*)(Random&), 6> kMakers = {make_ladder,    make_bent_lamp, make_open_rack,
                                                             make_open_rack, make_tripod,    make_poles};
  return kMakers[random.below(kMakers.size())](random);
}

}  // namespace

Furniture make_gear(GearKind kind, Random& random) {
  switch (kind) {
    case GearKind::swivel_chair:
      return make_swivel_chair(random);
    case GearKind::plain_chair:
      return make_plain_chair(random);
    case GearKind::monitors:
      return make_monitors(random);
    case GearKind::trolley:
      return centred(make_trolley, random);
    case GearKind::walker:
      return centred(make_walker, random);
    case GearKind::wheelchair:
      return make_empty_wheelchair(random);
    case GearKind::drip_stand:
      return make_drip_stand(random);
    case GearKind::dressed_machine:
      return make_dressed_machine(random);
    case GearKind::coat_stand:
      return make_full_coat_stand(random);
    case GearKind::thin_thing:
      return make_thin_thing(random);
  }
  return {};
}

}  // namespace vesalius::synth
