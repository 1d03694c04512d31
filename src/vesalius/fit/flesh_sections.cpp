#include "vesalius/fit/flesh_sections.h"

#include <algorithm>

namespace vesalius {

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

}  // namespace vesalius
