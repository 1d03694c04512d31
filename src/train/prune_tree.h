#pragma once

#include <cstddef>
#include <vector>

#include "vesalius/forest/forest.h"

namespace vesalius {

/// A node of a tree being grown. Nodes are kept in the order of growing, parents before their children.
struct GrownNode {
  TreeNode split;                   ///< offsets and threshold
  std::size_t left = 0, right = 0;  ///< indices of the children; 0: this is a leaf
  TreeLeaf leaf;                    ///< what it says as a leaf
};

/// Returns the tree below nodes[0], depth first and left before right. Where both children of a node are leaves that
/// say the same, the node becomes that leaf.
Tree pruned_tree(const std::vector<GrownNode>& nodes);

}  // namespace vesalius
