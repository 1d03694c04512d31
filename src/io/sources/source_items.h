#pragma once

#include <string>
#include <vector>

#include "vesalius/frame_source.h"

namespace vesalius {

/// Returns a message with the lines of `items` below it.
std::string with_items(const std::string& message, const std::vector<SourceItem>& items);

}  // namespace vesalius
