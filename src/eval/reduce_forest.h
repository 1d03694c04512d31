#pragma once

#include "vesalius/forest/forest.h"

namespace vesalius {

/// Returns the forest with the likeliest class alone in every leaf, the first of equals: a forest of votes.
Forest with_hard_votes(Forest forest);

/// Returns the forest of the first `count` trees. Throws Error unless there are as many.
Forest with_first_trees(const Forest& forest, int count);

}  // namespace vesalius
