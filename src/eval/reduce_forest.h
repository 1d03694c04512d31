#pragma once

#include "vesalius/forest/forest.h"

namespace vesalius {

/// Every leaf left with its likeliest class alone, the first of equals: what a forest of votes would have stored.
Forest with_hard_votes(Forest forest);

/// The first `count` trees. Throws Error unless there are as many.
Forest with_first_trees(const Forest& forest, int count);

}  // namespace vesalius
