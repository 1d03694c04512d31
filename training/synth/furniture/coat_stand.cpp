#include "synth/furniture/coat_stand.h"

#include <cmath>

#include "synth/furniture/furniture_builder.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

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

}  // namespace

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

}  // namespace vesalius::synth
