#include "vesalius/merge/joint_spread.h"

#include <algorithm>
#include <array>

namespace vesalius {
namespace {

constexpr float kWithin_m = 0.1F;

struct Quantile {
  float probability, radius;
};
/// Radii within which a normally distributed point in space lies, in standard deviations: quantiles of the chi
/// distribution of three degrees of freedom.
constexpr std::array kRadii = {Quantile{0.01F, 0.339F}, Quantile{0.05F, 0.593F}, Quantile{0.1F, 0.764F},
                               Quantile{0.2F, 1.003F},  Quantile{0.3F, 1.193F},  Quantile{0.4F, 1.367F},
                               Quantile{0.5F, 1.538F},  Quantile{0.6F, 1.716F},  Quantile{0.7F, 1.914F},
                               Quantile{0.8F, 2.154F},  Quantile{0.9F, 2.500F},  Quantile{0.95F, 2.796F},
                               Quantile{0.99F, 3.368F}};

/// Returns the value at `at` on the line through the points whose places and values are those members.
float between(float at, float Quantile::*place, float Quantile::*value) {
  const auto after = std::ranges::lower_bound(kRadii, at, {}, place);
  if (after == kRadii.begin()) return kRadii.front().*value;
  if (after == kRadii.end()) return kRadii.back().*value;
  const Quantile &low = *(after - 1), &high = *after;
  const float share = (at - low.*place) / (high.*place - low.*place);
  return low.*value + share * (high.*value - low.*value);
}

}  // namespace

float sigma_of(float confidence) { return kWithin_m / between(confidence, &Quantile::probability, &Quantile::radius); }

float confidence_of(float sigma_m) {
  return between(kWithin_m / std::max(sigma_m, 1e-6F), &Quantile::radius, &Quantile::probability);
}

}  // namespace vesalius
