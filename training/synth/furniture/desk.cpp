#include "synth/furniture/desk.h"

#include "synth/furniture/furniture_builder.h"
#include "synth/furniture/make_furniture.h"
#include "synth/furniture/small_things.h"

namespace vesalius::synth {
namespace {

using Eigen::AngleAxisf;
using Eigen::Isometry3f;
using Eigen::Vector3f;

}  // namespace

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

}  // namespace vesalius::synth
