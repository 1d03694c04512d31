#pragma once

#include "vesalius/forest/forest.h"

namespace vesalius {

/// Returns the forest with only the likeliest class in every leaf, which makes it a forest of votes. Among equals the
/// first is taken.
Forest with_hard_votes(Forest forest);

/// Returns the forest of the first `count` trees. Throws Error if there are fewer.
Forest with_first_trees(const Forest& forest, int count);

}  // namespace vesalius
