#pragma once

#include <vector>

#include "train/growing_tree.h"
#include "train/leaves/leaf_shard.h"
#include "train/samples/training_set.h"
#include "train/sharded.h"
#include "train/tree_shard.h"

namespace vesalius {

/// The shards of one tree on the processor, each on all allowed threads.
class LocalTree : public ShardedTree<TreeShard> {
 public:
  /// Makes one shard for each set, in the order of their frames; there is at least one. The sets must outlive this
  /// object and not change.
  LocalTree(const std::vector<const TrainingSet*>& sets, const GrowTreeOptions& options, int tree);

  /// Instead of all levels above: moves the samples to the children that they reach in `tree`, and counts them.
  ChildCounts walk_to(const OpenTree& tree);
};

/// The shards of learning leaves on the processor, each on all allowed threads.
class LocalLeaves : public ShardedLeaves<LeafShard> {
 public:
  /// As LocalTree.
  LocalLeaves(const std::vector<const TrainingSet*>& sets, const Forest& forest, const LogitLayout& layout);
};

}  // namespace vesalius
