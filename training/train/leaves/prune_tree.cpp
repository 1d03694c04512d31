#include "train/leaves/prune_tree.h"

#include <cstdint>

namespace vesalius {
namespace {

std::int32_t add_leaf(Tree& tree, const TreeLeaf& leaf) {
  tree.leaves.push_back(leaf);
  return ~static_cast<std::int32_t>(tree.leaves.size() - 1);
}

/// Returns how a parent refers to the subtree.
std::int32_t add_subtree(Tree& tree, const std::vector<GrownNode>& nodes, std::size_t at) {
  const GrownNode& grown = nodes[at];
  if (grown.left == 0) return add_leaf(tree, grown.leaf);
  const std::size_t index = tree.nodes.size();
  tree.nodes.push_back(grown.split);
  const std::int32_t left = add_subtree(tree, nodes, grown.left);
  const std::int32_t right = add_subtree(tree, nodes, grown.right);
  const auto leaf = [&](std::int32_t child) { return tree.leaves[~child]; };
  if (left < 0 && right < 0 && leaf(left) == leaf(right)) {
    const TreeLeaf same = leaf(left);
    tree.nodes.pop_back();
    tree.leaves.resize(tree.leaves.size() - 2);
    return add_leaf(tree, same);
  }
  tree.nodes[index].left = left;
  tree.nodes[index].right = right;
  return static_cast<std::int32_t>(index);
}

}  // namespace

Tree pruned_tree(const std::vector<GrownNode>& nodes) {
  Tree tree;
  add_subtree(tree, nodes, 0);
  return tree;
}

}  // namespace vesalius
