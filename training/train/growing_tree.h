#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "train/messages/grow_options.h"
#include "train/messages/training_messages.h"
#include "vesalius/forest.h"

namespace vesalius {

/// Computes the class shares of leaves.
class LeafShares {
 public:
  /// `counts` are those of all samples; the first `parts` classes are body parts. `options` say how far shares
  /// compensate for the sizes of the classes.
  LeafShares(const SampleCounts& counts, int parts, const LeafOptions& options);

  /// Returns the shares of the four largest classes (the lower one on a tie) in 1/255, rounded down. `counts` are the
  /// leaf's samples of each class, not all 0.
  TreeLeaf leaf(const std::int64_t* counts) const;

 private:
  void balance_parts(const std::int64_t* counts, std::vector<std::uint64_t>& shares) const;

  std::vector<std::uint64_t> weights_;  ///< weight of one sample of a class, up to 2^24
  std::vector<std::uint64_t> balance_;  ///< likewise for distributing among the parts; empty if equal to weights_
};

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

/// A node of the level that is to be split.
struct OpenNode {
  LevelNode node;
  std::size_t at = 0;  ///< index in GrowingTree::nodes
  int classes = 0;     ///< number of its samples' classes
  TreeNode split;      ///< the best so far
  double gain = 0;     ///< its bits per sample; 0 if there is none
};

/// A node from which a tree grows: the root, or one of another tree's level.
struct TreeRoot {
  std::uint32_t number = 1;          ///< numbered as in a heap
  std::vector<std::int64_t> counts;  ///< [class]: its samples in all shards
};

/// A tree whose leaves are where samples wait: each leads to a child, or to kSettled.
struct OpenTree {
  Tree tree;  ///< nodes only
  std::vector<std::int32_t> child_of_leaf;
  std::size_t children = 0;

  static void visit_fields(auto&& visit, auto&... of) {
    visit("tree", of.tree...)("child of leaf", of.child_of_leaf...)("children", of.children...);
  }
};

/// The driver's side of a growing tree: its nodes so far, and the level that is to be split.
class GrowingTree {
 public:
  /// `samples` are those of the whole training, `parts` the classes that are parts of a body.
  GrowingTree(const SampleCounts& samples, int parts, const GrowTreeOptions& options);

  /// Begins with some roots, which are the children of no level. Returns as `descend` does.
  std::vector<std::int32_t> begin(std::span<const TreeRoot> roots);
  const std::vector<OpenNode>& level() const { return level_; }
  /// Takes a split of a node of the level if it gains at least `min_gain` and more than those before. Returns whether
  /// it did.
  bool offer(std::int32_t node, const TreeNode& split, double gain);
  /// Makes the children, numbered as in ChildCounts, of all nodes with a split; they become the next level. Returns for
  /// each child its index there or kSettled.
  std::vector<std::int32_t> descend(const ChildCounts& children);

  /// Returns the tree whose leaves lead to the nodes of the level.
  OpenTree open_level() const;
  /// Returns the tree whose leaves lead to the children of the level's nodes that have a split.
  OpenTree open_children() const;

  /// Puts a tree that grew elsewhere in the place of a node of the level; its first node is the root.
  void graft(std::int32_t node, std::span<const GrownNode> grown);
  /// Ends the level: nodes that neither have a split nor were grafted are leaves.
  void close() { level_.clear(); }

  /// All nodes; roots come first.
  const std::vector<GrownNode>& nodes() const { return nodes_; }
  /// Returns the nodes below one of them, which becomes the first.
  std::vector<GrownNode> subtree(std::size_t at) const;

  /// Samples times levels that are done, of samples times `max_depth`.
  std::int64_t settled() const { return settled_; }
  /// Inner nodes.
  std::int64_t split_nodes() const { return split_nodes_; }

 private:
  std::int32_t open_or_settle(std::uint32_t number, std::size_t at, const std::int64_t* counts);
  OpenTree open_tree(bool children) const;

  std::size_t classes_;
  GrowTreeOptions options_;
  LeafShares leaves_;
  std::vector<OpenNode> level_;
  std::vector<GrownNode> nodes_;
  std::int64_t settled_ = 0, split_nodes_ = 0;
};

/// Splits a range of nodes into runs of at most `most` together by `size_of`, but of one node at least.
template <class SizeOf>
std::vector<NodeRange> node_runs(NodeRange nodes, std::int64_t most, const SizeOf& size_of) {
  std::vector<NodeRange> runs;
  std::int64_t size = 0;
  for (std::int32_t n = nodes.begin; n < nodes.end; ++n) {
    const std::int64_t more = size_of(n);
    if (runs.empty() || size + more > most) {
      runs.push_back({n, n});
      size = 0;
    }
    runs.back().end = n + 1;
    size += more;
  }
  return runs;
}

/// Returns the smallest number of a node's counted samples on a side at which about `min_samples` of all go there.
int least_samples(const LevelNode& node, const LeafOptions& options);

/// Returns the node's depth: 0 for the root.
int depth_of(std::uint32_t number);

}  // namespace vesalius
