#include "synth/furniture/garments.h"

#include <array>

namespace vesalius::synth {

using Eigen::Vector3f;

void hang_sleeve(FurnitureBuilder& piece, const Vector3f& shoulder, float side, std::uint8_t cloth, Random& random) {
  const float length = between(0.35, 0.6, random), wide = between(0.04, 0.075, random);
  const Vector3f cuff = shoulder + Vector3f{side * between(0.0, 0.1, random), -length, between(-0.02, 0.08, random)};
  const std::array<Ring, 3> rings = {Ring{shoulder, wide, wide}, Ring{0.5F * (shoulder + cuff), 0.9F * wide, wide},
                                     Ring{cuff, 0.75F * wide, 0.8F * wide}};
  add_garment(piece.piece.mesh, rings, 3, 0.3F * wide, cloth);
}

void hang_garment(FurnitureBuilder& piece, const Vector3f& from, float length_m, Random& random) {
  const std::uint8_t cloth = piece.stuff(Stuff::cloth);
  const bool hanger = chance(0.6, random);  // otherwise it hangs by its collar
  const float shoulder = hanger ? between(0.17, 0.24, random) : between(0.08, 0.15, random);
  const float thick = between(0.05, 0.1, random), hem = between(0.9, 1.4, random);
  const auto at = [&](float share) -> Vector3f { return from - Vector3f(0.F, share * length_m, 0.F); };
  const std::array<Ring, 5> rings = {Ring{from, 0.04F, 0.03F}, Ring{at(0.1F), shoulder, 0.7F * thick},
                                     Ring{at(0.35F), shoulder * between(0.9, 1.1, random), thick},
                                     Ring{at(0.65F), shoulder * hem * 0.95F, thick},
                                     Ring{at(1.F), shoulder * hem, thick * between(0.9, 1.2, random)}};
  add_garment(piece.piece.mesh, rings, 4 + int(random.below(6)), between(0.01, 0.04, random), cloth);
  if (chance(0.8, random)) {
    for (const float side : {-1.F, 1.F}) {
      hang_sleeve(piece, at(0.12F) + Vector3f(side * 0.9F * shoulder, 0.F, 0.F), side, cloth, random);
    }
  }
  piece.solid(from - Vector3f(shoulder, length_m, thick), from + Vector3f(shoulder, 0.F, thick));
}

void cover_chair_back(FurnitureBuilder& chair, const Vector3f& top, float width_m, Random& random) {
  const std::uint8_t cloth = chair.stuff(Stuff::cloth);
  const float half = 0.5F * width_m + between(0.01, 0.05, random), thick = between(0.06, 0.11, random);
  const float length = between(0.4, 0.75, random);
  const auto at = [&](float share) -> Vector3f { return top + Vector3f(0.F, 0.03F - share * length, 0.F); };
  const std::array<Ring, 4> rings = {Ring{at(0.F), 0.5F * half, 0.4F * thick}, Ring{at(0.08F), half, 0.8F * thick},
                                     Ring{at(0.5F), half * between(0.95, 1.1, random), thick},
                                     Ring{at(1.F), half * between(0.9, 1.1, random), 1.1F * thick}};
  add_garment(chair.piece.mesh, rings, 4 + int(random.below(5)), between(0.01, 0.03, random), cloth);
  for (const float side : {-1.F, 1.F}) {
    hang_sleeve(chair, at(0.1F) + Vector3f(side * half, 0.F, 0.F), side, cloth, random);
  }
}

}  // namespace vesalius::synth
