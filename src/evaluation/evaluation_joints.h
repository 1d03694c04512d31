#pragma once

#include <string>

#include "vesalius/base/body_model.h"

namespace vesalius {

/// Returns `body` with the joint sets of other trackers and data sets (data/joints/evaluation.toml) behind its own.
/// Returns it unchanged where it has any of them already or lacks one of the parts that they are made from.
BodyModel with_evaluation_joints(const BodyModel& body);

/// Returns `body` with the joint sets of a TOML file behind its own. Throws Error as parse_body_model does.
BodyModel with_joints_of(const BodyModel& body, const std::string& file);

}  // namespace vesalius
