#pragma once

#include <string>
#include <string_view>

#include "vesalius/model.h"

namespace vesalius {

/// Version of the model files that parse_old_model reads: one checksum, no sections.
inline constexpr int kOldModelVersion = 2;

/// Reads a model file of that version for `vesalius convert`; `name` is used as the path in errors. Throws Error if it
/// is truncated or damaged (by its checksum).
Model parse_old_model(std::string_view bytes, const std::string& name);

}  // namespace vesalius
