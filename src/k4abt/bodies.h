#pragma once

#include <k4abttypes.h>

#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/person.h"

namespace vesalius::k4abt {

/// Returns somebody's joints in the units and axes of the interface. A joint without a place has that of the next joint
/// towards the pelvis that has one, or of the trunk, and no confidence; so has one without a rotation its rotation.
/// `joints` are those of `set`, which is k4abt32.
k4abt_body_t to_body(const TrackedPerson& person, const std::vector<Joint>& joints, const JointSet& set);

}  // namespace vesalius::k4abt
