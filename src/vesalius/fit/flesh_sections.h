#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "vesalius/base/capsule.h"
#include "vesalius/fit/body_state.h"
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

/// Returns the flesh of a body, roughly, in the optical frame: a capsule for each bone, three side by side for those
/// whose flesh is flat, such as the chest's.
std::vector<Capsule> flesh_capsules(const FleshModel& flesh, const BodyState& state);

}  // namespace vesalius
