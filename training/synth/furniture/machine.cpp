#include "synth/furniture/machine.h"

#include <cmath>

#include "synth/furniture/furniture_builder.h"

namespace vesalius::synth {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;

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

}  // namespace

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

}  // namespace vesalius::synth
