#pragma once

#include <string>

#include "vesalius/body_model.h"

namespace vesalius {

/// Returns `body` with the joint sets of other trackers and data sets (data/joints/evaluation.toml) after its own.
/// Returns it unchanged if it has any of them already or lacks a part on which they depend.
BodyModel with_evaluation_joints(const BodyModel& body);

/// Returns `body` with the joint sets of a TOML file after its own. Throws Error as parse_body_model does.
BodyModel with_joints_of(const BodyModel& body, const std::string& file);

}  // namespace vesalius
