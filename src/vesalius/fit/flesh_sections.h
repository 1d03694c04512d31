#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "vesalius/fit/flesh_model.h"
#include "vesalius/person.h"

namespace vesalius {

/// An ellipse across a bone: the surface is centre + cos(t) first + sin(t) second. Metres, optical frame.
struct FleshSection {
  Eigen::Vector3f centre, first, second;
};

/// The flesh of a bone: its surface goes straight from one section to the next, from head to tail, and ends in halves
/// of ellipsoids that reach as far along the bone as the smaller half width of the last section.
using BoneSections = std::array<FleshSection, FleshBone::kStations>;

/// Returns the flesh of each bone of a body that was fitted with this model, for whoever draws it.
std::vector<BoneSections> flesh_sections(const FleshModel& flesh, const FittedBody& fitted);

}  // namespace vesalius
