#pragma once

#include <vector>

#include "vesalius/frame.h"

namespace vesalius {

/// Eight frames of 640x480 at 10 per second, with sensor noise: one person waves, one walks across the room, one stands
/// half hidden by a box.
std::vector<LabelledFrame> sample_sequence();

}  // namespace vesalius
