#pragma once

#include <cstddef>
#include <vector>

#include "vesalius/forest/forest.h"

namespace vesalius {

/// A node in the order of growing, parents first.
struct GrownNode {
  TreeNode split;                   ///< offsets and threshold
  std::size_t left = 0, right = 0;  ///< indices of the children; 0: this is a leaf
  TreeLeaf leaf;                    ///< what it says as a leaf
};

/// The tree below nodes[0], depth first, left before right. Where both children are leaves that say the same, their
/// parent is the leaf.
Tree pruned_tree(const std::vector<GrownNode>& nodes);

}  // namespace vesalius
