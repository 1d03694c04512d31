#include "vesalius/fit/flesh_capsules.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vesalius {
namespace {

constexpr double kFlat_m = 0.02;  // by which the half widths must differ

/// The flesh at one end of a bone, in the bone's frame.
struct End {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0.0;                              ///< half of the smaller width
  Eigen::Vector3d aside = Eigen::Vector3d::Zero();  ///< to where the larger width ends, less the radius
};

End end_of(const FleshBone& bone, const PlacedBone& placed, int station) {
  const std::array<int, 2> across = axes_across(bone.axis);
  const double* numbers = placed.numbers.data() + 6 + 4 * station;
  const int wide = numbers[2] > numbers[3] ? 0 : 1;
  End end;
  end.centre[bone.axis] = static_cast<double>(bone.stations[station]) * placed.numbers[3 + bone.axis];
  for (int i = 0; i < 2; ++i) end.centre[across[i]] = numbers[i];
  end.radius = std::max(0.0, std::min(numbers[2], numbers[3]));
  end.aside[across[wide]] = std::abs(numbers[2] - numbers[3]);
  return end;
}

}  // namespace

std::vector<Capsule> flesh_capsules(const FleshModel& flesh, const BodyState& state) {
  const std::vector<PlacedBone> placed = place_bones(flesh, state);
  std::vector<Capsule> capsules;
  for (int b = 0; b < flesh.bone_count(); ++b) {
    const FleshBone& bone = flesh.bones[b];
    const End head = end_of(bone, placed[b], 0), tail = end_of(bone, placed[b], FleshBone::kStations - 1);
    const bool flat = std::max(head.aside.norm(), tail.aside.norm()) > kFlat_m;
    for (int side = flat ? -1 : 0; side <= (flat ? 1 : 0); ++side) {
      const auto at = [&](const End& end) -> Eigen::Vector3f {
        return (placed[b].head + placed[b].global * (end.centre + side * end.aside)).cast<float>();
      };
      capsules.push_back({at(head), at(tail), static_cast<float>(head.radius), static_cast<float>(tail.radius)});
    }
  }
  return capsules;
}

}  // namespace vesalius
