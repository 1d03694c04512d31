#include "vesalius/fit/flesh_sections.h"

#include <algorithm>
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
  const FleshEllipse<double> ellipse = ellipse_of(bone, placed.numbers, station);
  const auto& [first, second] = ellipse.half;
  End end;
  end.centre = ellipse.centre;
  end.radius = std::max(0.0, std::min(first, second));
  end.aside[ellipse.across[first > second ? 0 : 1]] = std::abs(first - second);
  return end;
}

}  // namespace

std::vector<BoneSections> flesh_sections(const FleshModel& flesh, const FittedBody& fitted) {
  Eigen::VectorXd shape = Eigen::VectorXd::Zero(flesh.shapes);
  for (Eigen::Index k = 0; k < shape.size() && k < static_cast<Eigen::Index>(fitted.shape.size()); ++k) {
    shape[k] = double(fitted.shape[static_cast<std::size_t>(k)]);
  }
  std::vector<BoneSections> all;
  for (std::size_t b = 0; b < std::min(flesh.bones.size(), fitted.bones.size()); ++b) {
    const FleshBone& bone = flesh.bones[b];
    const FittedBone& placed = fitted.bones[b];
    const FleshBone::Numbers numbers = numbers_of(bone, shape);
    BoneSections& sections = all.emplace_back();
    for (std::size_t s = 0; s < sections.size(); ++s) {
      const FleshEllipse<float> ellipse = ellipse_of(bone, numbers, int(s));
      const auto side = [&](int i) -> Eigen::Vector3f {
        return placed.global * (ellipse.half[i] * Eigen::Vector3f::Unit(ellipse.across[i]));
      };
      sections[s] = {placed.head + placed.global * ellipse.centre, side(0), side(1)};
    }
  }
  return all;
}

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
      capsules.push_back({at(head), at(tail), float(head.radius), float(tail.radius)});
    }
  }
  return capsules;
}

}  // namespace vesalius
