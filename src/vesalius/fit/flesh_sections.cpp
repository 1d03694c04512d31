#include "vesalius/fit/flesh_sections.h"

#include <algorithm>

namespace vesalius {

std::vector<BoneSections> flesh_sections(const FleshModel& flesh, const FittedBody& fitted) {
  Eigen::VectorXd shape = Eigen::VectorXd::Zero(flesh.shapes);
  for (Eigen::Index k = 0; k < shape.size() && k < static_cast<Eigen::Index>(fitted.shape.size()); ++k) {
    shape[k] = static_cast<double>(fitted.shape[static_cast<std::size_t>(k)]);
  }
  std::vector<BoneSections> all;
  for (std::size_t b = 0; b < std::min(flesh.bones.size(), fitted.bones.size()); ++b) {
    const FleshBone& bone = flesh.bones[b];
    const FittedBone& placed = fitted.bones[b];
    const FleshBone::Numbers numbers = numbers_of(bone, shape);
    const std::array<int, 2> across = axes_across(bone.axis);
    BoneSections& sections = all.emplace_back();
    for (std::size_t s = 0; s < sections.size(); ++s) {
      Eigen::Vector3f at = Eigen::Vector3f::Zero(), first = at, second = at;
      at[bone.axis] = bone.stations[s] * numbers[3 + bone.axis];
      at[across[0]] = numbers[6 + 4 * s];
      at[across[1]] = numbers[7 + 4 * s];
      first[across[0]] = numbers[8 + 4 * s];
      second[across[1]] = numbers[9 + 4 * s];
      sections[s] = {placed.head + placed.global * at, placed.global * first, placed.global * second};
    }
  }
  return all;
}

}  // namespace vesalius
