#include "synth/furniture/make_furniture.h"

#include <algorithm>
#include <cmath>

#include "synth/furniture/seats.h"

namespace vesalius::synth {
namespace {

using Eigen::AngleAxisf;
using Eigen::Isometry3f;
using Eigen::Vector3f;

Furniture make_desk(Random& random) {
  const float height = between(0.68, 0.78, random);
  const float long_side = between(1.0, 1.7, random), short_side = between(0.55, 0.8, random);
  Furniture desk = make_table(long_side, short_side, height, random);
  FurnitureBuilder top(random);
  top.piece = std::move(desk);
  const std::uint8_t black = top.stuff(Stuff::plastic), screen = top.stuff(Stuff::glass);
  const float width = between(0.4, 0.65, random), x = between(-0.15, 0.15, random), z = -0.12F;
  const float low = height + between(0.08, 0.15, random), tall = width * between(0.55, 0.65, random);
  top.box({x - 0.1F, height, z - 0.08F}, {x + 0.1F, height + 0.015F, z + 0.08F}, black);
  top.box({x - 0.02F, height, z - 0.03F}, {x + 0.02F, low + 0.1F, z - 0.01F}, black);
  top.box({x - width / 2, low, z}, {x + width / 2, low + tall, z + 0.03F}, black);
  add_box(top.piece.mesh, Vector3f(x - width / 2 + 0.01F, low + 0.01F, z + 0.03F),
          Vector3f(x + width / 2 - 0.01F, low + tall - 0.01F, z + 0.032F), screen);
  top.box({x - 0.2F, height, z + 0.17F}, {x + 0.22F, height + 0.025F, z + 0.3F}, black);
  return std::move(top.piece);
}

Furniture draw_table(Random& random) {
  const float width = between(0.5, 1.8, random), depth = between(0.45, 0.95, random);
  const float height = between(0.35, 0.78, random);
  return make_table(width, depth, height, random);
}

Furniture draw_bed(Random& random) {
  const float width = between(0.8, 1.8, random), length = between(1.9, 2.1, random), height = between(0.3, 0.6, random);
  return make_bed(width, length, height, random);
}

Furniture make_shelf(Random& random) {
  FurnitureBuilder shelf(random);
  const std::uint8_t wood = shelf.stuff(Stuff::wood);
  const float half = between(0.3, 0.7, random), depth = between(0.22, 0.4, random), height = between(0.7, 2.1, random);
  constexpr float kBoard = 0.02F;
  for (const float x : {-half, half - kBoard}) shelf.box({x, 0.F, 0.F}, {x + kBoard, height, depth}, wood);
  if (chance(0.6, random)) shelf.box({-half, 0.F, -0.01F}, {half, height, 0.F}, wood);
  const int boards = 3 + int(random.below(3));
  for (int i = 0; i < boards; ++i) {
    const float y = 0.05F + (height - 0.07F) * float(i) / float(boards - 1);
    shelf.box({-half, y, 0.F}, {half, y + kBoard, depth}, wood);
    if (i + 1 == boards) break;
    for (float x = -half + 0.03F; x < half - 0.12F;) {  // books and boxes
      const float wide = between(0.03, 0.14, random), tall = between(0.1, 0.24, random);
      if (chance(0.7, random)) {
        const float deep = depth * between(0.5, 0.95, random);
        const std::uint8_t cover = shelf.stuff(Stuff::cloth);
        add_box(shelf.piece.mesh, Vector3f(x, y + kBoard, 0.01F), Vector3f(x + wide, y + kBoard + tall, deep), cover);
      }
      x += wide + 0.004F;
    }
  }
  move(shelf.piece, standing_at(0.F, 0.F, -depth / 2, 0.F));
  return std::move(shelf.piece);
}

Furniture make_wardrobe(Random& random) {
  FurnitureBuilder wardrobe(random);
  const std::uint8_t body = wardrobe.stuff(chance(0.6, random) ? Stuff::wood : Stuff::paint);
  const std::uint8_t knob = wardrobe.stuff(Stuff::metal);
  const float half = between(0.25, 0.9, random), depth = between(0.4, 0.65, random), height = between(0.7, 2.2, random);
  wardrobe.box({-half, 0.F, -depth / 2}, {half, height, depth / 2}, body);
  const int doors = std::max(1, int(half * 2.F / 0.45F));
  const float wide = 2.F * half / float(doors);
  for (int i = 0; i < doors; ++i) {
    const float x = -half + wide * float(i);
    add_box(wardrobe.piece.mesh, Vector3f(x + 0.004F, 0.08F, depth / 2),
            Vector3f(x + wide - 0.004F, height - 0.01F, depth / 2 + 0.018F), body);
    add_cone(wardrobe.piece.mesh, {x + 0.04F, height * 0.5F, depth / 2 + 0.018F},
             {x + 0.04F, height * 0.5F, depth / 2 + 0.05F}, 0.012F, 0.015F, knob, 6);
  }
  return std::move(wardrobe.piece);
}

Furniture make_lamp(Random& random) {
  FurnitureBuilder lamp(random);
  const std::uint8_t metal = lamp.stuff(Stuff::metal), shade = lamp.stuff(Stuff::cloth);
  const float height = between(1.2, 1.9, random), radius = between(0.12, 0.25, random);
  lamp.post(0.F, 0.F, 0.F, 0.025F, between(0.1, 0.17, random), metal);
  lamp.post(0.F, 0.F, 0.F, height - 0.05F, 0.012F, metal);
  lamp.cone({0.F, height - 0.28F, 0.F}, {0.F, height, 0.F}, radius, radius * between(0.5, 1.0, random), shade);
  return std::move(lamp.piece);
}

Furniture make_plant(Random& random) {
  FurnitureBuilder plant(random);
  const std::uint8_t pot = plant.stuff(Stuff::paint), leaf = plant.stuff(Stuff::leaf), stem = plant.stuff(Stuff::wood);
  const float pot_height = between(0.15, 0.4, random), pot_radius = between(0.08, 0.2, random);
  const float height = pot_height + between(0.3, 1.3, random);
  plant.cone({0.F, 0.F, 0.F}, {0.F, pot_height, 0.F}, pot_radius * 0.8F, pot_radius, pot);
  plant.post(0.F, 0.F, pot_height - 0.02F, height * 0.8F, 0.012F, stem);
  const float spread = between(0.15, 0.4, random), length = between(0.12, 0.35, random);
  const int leaves = 14 + int(random.below(26));
  for (int i = 0; i < leaves; ++i) {
    const float turn = between(0.0, 6.2832, random), y = between(pot_height, height - 0.05, random);
    const Vector3f out(std::cos(turn), 0.F, std::sin(turn)), side(-out.z(), 0.F, out.x());
    const Vector3f foot = Vector3f(0.F, y, 0.F) + out * 0.02F;
    const Vector3f tip = foot + out * spread + Vector3f(0.F, between(-0.3, 0.5, random) * length, 0.F);
    const Vector3f middle = 0.5F * (foot + tip) + Vector3f(0.F, 0.15F * length, 0.F);
    const float half_width = 0.18F * length;
    add_quad(plant.piece.mesh, foot, middle + half_width * side, tip, middle - half_width * side, leaf);
  }
  Eigen::AlignedBox3f crown;
  for (const Vector3f& p : plant.piece.mesh.vertices) crown.extend(p);
  crown.min().y() = pot_height;
  const Vector3f give = Vector3f(0.15F, 0.F, 0.15F).cwiseProduct(crown.sizes());  // leaves yield
  plant.solid(crown.min() + give, crown.max() - give);
  return std::move(plant.piece);
}

Furniture make_box(Random& random) {
  FurnitureBuilder box(random);
  const std::uint8_t card = box.stuff(chance(0.6, random) ? Stuff::cardboard : Stuff::plastic);
  float low = 0.F, x = between(0.1, 0.4, random), z = between(0.1, 0.4, random);
  const int stack = chance(0.3, random) ? 2 : 1;
  for (int i = 0; i < stack; ++i) {
    const float height = between(0.15, 0.6, random);
    box.box({-x, low, -z}, {x, low + height, z}, card);
    low += height;
    x *= between(0.6, 1.0, random);
    z *= between(0.6, 1.0, random);
  }
  return std::move(box.piece);
}

Furniture make_beanbag(Random& random) {
  FurnitureBuilder bag(random);
  const Vector3f half{between(0.25, 0.5, random), between(0.12, 0.35, random), between(0.25, 0.5, random)};
  Isometry3f pose = Isometry3f::Identity();
  pose.translation().y() = 0.95F * half.y();
  add_ellipsoid(bag.piece.mesh, pose, half, bag.stuff(Stuff::cloth), 12);
  const Vector3f inner = half.cwiseProduct(Vector3f(0.8F, 0.9F, 0.8F));
  bag.solid(pose.translation() - inner, pose.translation() + inner);
  return std::move(bag.piece);
}

Furniture make_pillar(Random& random) {
  FurnitureBuilder pillar(random);
  const std::uint8_t paint = pillar.stuff(Stuff::wall);
  const float radius = between(0.1, 0.3, random), height = between(1.8, 3.5, random);
  if (chance(0.5, random)) {
    pillar.post(0.F, 0.F, 0.F, height, radius, paint);
  } else {
    pillar.box({-radius, 0.F, -radius}, {radius, height, radius}, paint);
  }
  return std::move(pillar.piece);
}

Furniture make_panel(Random& random) {
  FurnitureBuilder panel(random);
  const std::uint8_t board = panel.stuff(chance(0.5, random) ? Stuff::wall : Stuff::wood);
  const float width = between(0.3, 1.4, random), height = between(0.5, 2.4, random);
  const float thickness = between(0.02, 0.08, random);
  const float lean = chance(0.4, random) ? between(-0.3, 0.3, random) : 0.F;
  Isometry3f pose(AngleAxisf(lean, Vector3f::UnitZ()));
  pose.translation().y() = 0.5F * (height * std::cos(lean) + width * std::abs(std::sin(lean)));
  panel.box(pose, {width, height, thickness}, board);
  return std::move(panel.piece);
}

void add_blob(FurnitureBuilder& piece, const Vector3f& centre, const Vector3f& half, std::uint8_t material) {
  add_ellipsoid(piece.piece.mesh, placed_at(centre), half, material, 10);
}

/// Adds a hanging coat as rings around its shoulders, chest, waist and hem.
void add_coat(FurnitureBuilder& piece, const Vector3f& shoulders, float length, Random& random) {
  const std::uint8_t cloth = piece.stuff(Stuff::cloth);
  const float half = between(0.17, 0.24, random), thick = between(0.07, 0.13, random);
  add_blob(piece, shoulders - Vector3f(0.F, 0.25F * length, 0.F), {half, 0.3F * length, thick}, cloth);
  add_blob(piece, shoulders - Vector3f(0.F, 0.62F * length, 0.F), {0.95F * half, 0.4F * length, 1.1F * thick}, cloth);
  for (const float side : {-1.F, 1.F}) {
    const Vector3f top = shoulders + Vector3f(side * half * 0.85F, -0.06F, 0.F);
    const Vector3f cuff = top + Vector3f{side * between(0.02, 0.12, random), -between(0.4, 0.55, random), 0.03F};
    add_cone(piece.piece.mesh, top, cuff, 0.065F, 0.045F, cloth);
  }
  piece.solid(shoulders - Vector3f(half, length, thick), shoulders + Vector3f(half, 0.03F, thick));
}

/// Returns a stand with one or two hanging coats and perhaps a hat, which resembles a person.
Furniture make_coat_stand(Random& random) {
  FurnitureBuilder stand(random);
  const std::uint8_t wood = stand.stuff(chance(0.5, random) ? Stuff::wood : Stuff::metal);
  const float height = between(1.55, 1.95, random);
  stand.post(0.F, 0.F, 0.F, height, 0.02F, wood);
  stand.post(0.F, 0.F, 0.F, 0.03F, between(0.15, 0.22, random), wood);
  for (int i = 0; i < 4; ++i) {
    const float turn = 1.5708F * float(i);
    add_cone(stand.piece.mesh, {0.F, height - 0.15F, 0.F},
             {0.15F * std::cos(turn), height - 0.05F, 0.15F * std::sin(turn)}, 0.012F, 0.01F, wood, 6);
  }
  const int coats = 1 + int(random.below(2));
  for (int i = 0; i < coats; ++i) {
    const float top = height - between(0.1, 0.25, random), length = between(0.6, 1.1, random);
    add_coat(stand, {0.F, top, i == 0 ? 0.1F : -0.1F}, length, random);
  }
  if (chance(0.4, random)) {
    add_blob(stand, {0.F, height + 0.03F, 0.F}, {0.11F, 0.08F, 0.12F}, stand.stuff(Stuff::cloth));
  }
  return std::move(stand.piece);
}

/// Returns a torso on a pole, perhaps with a head, which resembles a person.
Furniture make_mannequin(Random& random) {
  FurnitureBuilder figure(random);
  const std::uint8_t skin = figure.stuff(chance(0.5, random) ? Stuff::cloth : Stuff::plastic);
  const std::uint8_t metal = figure.stuff(Stuff::metal);
  const float waist = between(0.85, 1.1, random), wide = between(0.15, 0.21, random);
  figure.post(0.F, 0.F, 0.F, waist, 0.015F, metal);
  figure.post(0.F, 0.F, 0.F, 0.02F, between(0.14, 0.2, random), metal);
  add_blob(figure, {0.F, waist + 0.02F, 0.F}, {wide * 0.9F, 0.17F, 0.11F}, skin);
  add_blob(figure, {0.F, waist + 0.3F, 0.F}, {wide, 0.25F, 0.12F}, skin);
  add_cone(figure.piece.mesh, {0.F, waist + 0.48F, 0.F}, {0.F, waist + 0.62F, 0.F}, 0.055F, 0.05F, skin);
  const bool head = chance(0.5, random);
  if (head) add_blob(figure, {0.F, waist + 0.72F, 0.01F}, {0.08F, 0.12F, 0.1F}, skin);
  figure.solid({-wide, waist - 0.15F, -0.12F}, {wide, waist + (head ? 0.84F : 0.62F), 0.12F});
  return std::move(figure.piece);
}

}  // namespace

Furniture make_table(float width_m, float depth_m, float height_m, Random& random) {
  FurnitureBuilder table(random);
  const std::uint8_t wood = table.stuff(chance(0.7, random) ? Stuff::wood : Stuff::paint);
  const float x = width_m / 2, z = depth_m / 2, board = between(0.02, 0.05, random);
  table.box({-x, height_m - board, -z}, {x, height_m, z}, wood);
  if (chance(0.75, random)) {
    table.legs(x - 0.02F, -z + 0.02F, z - 0.02F, height_m - board, between(0.03, 0.08, random), wood);
  } else {
    const std::uint8_t metal = table.stuff(Stuff::metal);
    table.post(0.F, 0.F, 0.F, height_m - board, between(0.03, 0.06, random), metal);
    table.post(0.F, 0.F, 0.F, 0.03F, 0.4F * std::min(width_m, depth_m), metal);
  }
  return std::move(table.piece);
}

Furniture make_furniture(FurnitureKind kind, Random& random) {
  const auto seat = [&](SeatKind seat_kind, double width_low, double width_high) {
    Furniture piece = make_seat({seat_kind, between(0.38, 0.5, random), between(width_low, width_high, random),
                                 between(0.38, 0.52, random), between(0.3, 0.6, random), between(0.0, 0.25, random)},
                                random);
    move(piece, standing_at(0.F, 0.F, -0.22F, 0.F));
    return piece;
  };
  switch (kind) {
    case FurnitureKind::chair:
      return seat(SeatKind::chair, 0.38, 0.5);
    case FurnitureKind::stool:
      return seat(SeatKind::stool, 0.3, 0.42);
    case FurnitureKind::armchair:
      return seat(SeatKind::armchair, 0.5, 0.65);
    case FurnitureKind::sofa:
      return seat(SeatKind::sofa, 1.2, 2.2);
    case FurnitureKind::bed:
      return draw_bed(random);
    case FurnitureKind::table:
      return draw_table(random);
    case FurnitureKind::desk:
      return make_desk(random);
    case FurnitureKind::shelf:
      return make_shelf(random);
    case FurnitureKind::wardrobe:
      return make_wardrobe(random);
    case FurnitureKind::lamp:
      return make_lamp(random);
    case FurnitureKind::plant:
      return make_plant(random);
    case FurnitureKind::box:
      return make_box(random);
    case FurnitureKind::beanbag:
      return make_beanbag(random);
    case FurnitureKind::pillar:
      return make_pillar(random);
    case FurnitureKind::coat_stand:
      return make_coat_stand(random);
    case FurnitureKind::mannequin:
      return make_mannequin(random);
    case FurnitureKind::panel:
      return make_panel(random);
  }
  return {};
}

void add_small_things(FurnitureBuilder& table, float half_x, float half_z, float height_m, Random& random) {
  const int count = int(random.below(9));
  for (int i = 0; i < count; ++i) {
    const Vector3f foot{between(-0.9, 0.9, random) * half_x, height_m, between(-0.9, 0.9, random) * half_z};
    const float wide = between(0.03, 0.1, random), tall = between(0.04, 0.3, random);
    const std::uint8_t stuff = table.stuff(chance(0.5, random) ? Stuff::plastic : Stuff::cardboard);
    switch (random.below(3)) {
      case 0:
        add_cone(table.piece.mesh, foot, foot + Vector3f(0.F, tall, 0.F), 0.6F * wide, 0.5F * wide, stuff);
        break;
      case 1: {
        Isometry3f pose(AngleAxisf(between(-1.5, 1.5, random), Vector3f::UnitY()));
        pose.translation() = foot + Vector3f(0.F, 0.5F * tall, 0.F);
        add_box(table.piece.mesh, pose, {2.F * wide, tall, 1.5F * wide}, stuff);
        break;
      }
      default:
        add_cushion(table.piece.mesh, standing_at(foot.x(), foot.y() + 0.4F * wide, foot.z(), 0.F),
                    {wide, 0.5F * wide, 0.8F * wide}, stuff);
    }
  }
}

Furniture make_desk_before(float height_m, Random& random) {
  const float width = between(1.0, 1.8, random), depth = between(0.6, 0.85, random);
  FurnitureBuilder desk(random);
  desk.piece = make_table(width, depth, height_m, random);
  if (chance(0.6, random)) {
    const std::uint8_t front = desk.stuff(Stuff::wood);
    const float top = height_m + (chance(0.3, random) ? between(0.1, 0.35, random) : -0.03F);
    desk.box({-0.5F * width, 0.05F, 0.5F * depth}, {0.5F * width, top, 0.5F * depth + 0.02F}, front);
  }
  const std::uint8_t black = desk.stuff(Stuff::plastic);
  const int screens = int(random.below(3));
  for (int i = 0; i < screens; ++i) {
    const float wide = between(0.35, 0.65, random), tall = wide * between(0.55, 0.75, random);
    Isometry3f pose(AngleAxisf(between(-0.4, 0.4, random), Vector3f::UnitY()));
    pose.rotate(AngleAxisf(between(-0.05, 0.25, random), Vector3f::UnitX()));
    const float x = 0.5F * (float(i) - 0.5F * float(screens - 1)) + between(-0.1, 0.1, random);
    pose.translation() = Vector3f{x, height_m + 0.5F * tall + between(0.03, 0.12, random), between(0.05, 0.2, random)};
    desk.box(pose, {wide, tall, between(0.02, 0.06, random)}, black);
    add_cone(desk.piece.mesh, {x, height_m, pose.translation().z()}, pose.translation(), 0.06F, 0.03F, black, 8);
  }
  add_small_things(desk, 0.45F * width, 0.4F * depth, height_m, random);
  move(desk.piece, standing_at(0.F, 0.F, 0.5F * depth, 0.F));
  return std::move(desk.piece);
}

Furniture make_counter(float height_m, Random& random) {
  const float half = between(0.5, 1.2, random), depth = between(0.3, 0.7, random);
  FurnitureBuilder counter(random);
  const std::uint8_t front = counter.stuff(chance(0.5, random) ? Stuff::wood : Stuff::wall);
  const std::uint8_t top = counter.stuff(Stuff::wood);
  counter.box({-half, 0.F, -0.5F * depth + 0.03F}, {half, height_m - 0.03F, 0.5F * depth - 0.03F}, front);
  counter.box({-half, height_m - 0.03F, -0.5F * depth}, {half, height_m, 0.5F * depth}, top);
  add_small_things(counter, 0.9F * half, 0.4F * depth, height_m, random);
  move(counter.piece, standing_at(0.F, 0.F, 0.5F * depth, 0.F));
  return std::move(counter.piece);
}

Furniture make_doorway(float height_m, float width_m, Random& random) {
  FurnitureBuilder wall(random);
  const std::uint8_t paint = wall.stuff(Stuff::wall), wood = wall.stuff(Stuff::wood);
  const float half = between(0.04, 0.13, random), wide = between(0.75, 1.1, random);
  const float top = std::min(height_m, between(1.95, 2.15, random));
  wall.box({-width_m, 0.F, -half}, {0.F, height_m, half}, paint);
  const bool whole = chance(0.6, random);  // else it ends at its edge
  if (whole) {
    wall.box({wide, 0.F, -half}, {wide + between(0.1, 1.0, random) * width_m, height_m, half}, paint);
    if (top < height_m) wall.box({0.F, top, -half}, {wide, height_m, half}, paint);
  }
  if (chance(0.7, random)) {
    const float deep = half + 0.015F;
    add_box(wall.piece.mesh, Vector3f(-0.06F, 0.F, -deep), Vector3f(0.012F, top, deep), wood);
    if (whole) add_box(wall.piece.mesh, Vector3f(wide - 0.012F, 0.F, -deep), Vector3f(wide + 0.06F, top, deep), wood);
    if (whole)
      add_box(wall.piece.mesh, Vector3f(-0.06F, top - 0.012F, -deep), Vector3f(wide + 0.06F, top + 0.06F, deep), wood);
  }
  return std::move(wall.piece);
}

}  // namespace vesalius::synth
