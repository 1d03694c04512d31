#pragma once

#include <vector>

#include "vesalius/base/capsule.h"
#include "vesalius/fit/body_state.h"
#include "vesalius/fit/flesh_model.h"

namespace vesalius {

/// Returns the flesh of a body, roughly, in the optical frame: a capsule for each bone, three side by side for those
/// whose flesh is flat, such as the chest's.
std::vector<Capsule> flesh_capsules(const FleshModel& flesh, const BodyState& state);

}  // namespace vesalius
