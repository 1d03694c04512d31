#pragma once

#include <cstddef>
#include <string_view>

#include "vesalius/base/body_model.h"

namespace vesalius {

/// Returns the index of the joint set of that name. Throws UsageError, which names those that there are, if there is
/// none.
std::size_t find_joint_set(const BodyModel& body, std::string_view name);

}  // namespace vesalius
