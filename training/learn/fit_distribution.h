#pragma once

#include <vector>

#include "learn/fit_joints.h"
#include "vesalius/body_model.h"

namespace vesalius {

/// Factors of a fitted distribution: about as many as limbs can bend. More hardly place parts better.
inline constexpr int kDistributionFactors = 16;

/// Returns the distribution of the parts' surfaces fitted to people whose parts' centres are all known. Each person
/// counts as a mirror image too. What lies between a part's surface and its centre, and how probable it is that a
/// predicted part is right, are learned from the parts that the detector observed and missed; the latter also with the
/// votes of those people who have some. Throws Error for fewer than 100 people.
PartDistribution fit_distribution(const std::vector<KnownPerson>& people, const BodyModel& body);

}  // namespace vesalius
