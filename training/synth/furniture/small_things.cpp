#include "synth/furniture/small_things.h"

namespace vesalius::synth {

using Eigen::AngleAxisf;
using Eigen::Isometry3f;
using Eigen::Vector3f;

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

}  // namespace vesalius::synth
