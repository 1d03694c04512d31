#pragma once

#include <cstddef>
#include <vector>

#include "vesalius/forest.h"

namespace vesalius {

/// A node of a growing tree. Nodes are in the order of growing, parents before their children.
struct GrownNode {
  TreeNode split;                   ///< offsets and threshold
  std::size_t left = 0, right = 0;  ///< indices of the children, or 0 for a leaf
  TreeLeaf leaf;                    ///< its shares as a leaf

  static void visit_fields(auto&& visit, auto&... of) {
    visit("split", of.split...)("left", of.left...)("right", of.right...)("leaf", of.leaf...);
  }
};

/// Returns the tree below nodes[0], depth first and left before right. If both children of a node are equal leaves, the
/// node becomes that leaf.
Tree pruned_tree(const std::vector<GrownNode>& nodes);

}  // namespace vesalius
