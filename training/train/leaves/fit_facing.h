#pragma once

#include <vector>

#include "train/messages/leaf_messages.h"
#include "vesalius/forest/facing.h"

namespace vesalius {

/// Learns the regression of headings by maximum likelihood with a quadratic prior. Each heading counts with its number
/// of people to the power of a half, so that frequent ones are expected half as much more often than they are seen.
/// Returns a model without weights if a heading has nobody.
FacingModel fit_facing(const std::vector<FacingSample>& samples, int parts, int headings);

}  // namespace vesalius
