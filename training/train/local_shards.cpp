#include "train/local_shards.h"

namespace vesalius {

LocalTree::LocalTree(const std::vector<const TrainingSet*>& sets, const GrowTreeOptions& options, int tree) {
  shards_.reserve(sets.size());
  for (const TrainingSet* set : sets) shards_.emplace_back(*set, options, tree);
}

ChildCounts LocalTree::walk_to(const OpenTree& tree) {
  return merged(shards_, [&](TreeShard& shard) { return shard.walk_to(tree); });
}

LocalLeaves::LocalLeaves(const std::vector<const TrainingSet*>& sets, const Forest& forest, const LogitLayout& layout) {
  for (const TrainingSet* set : sets) shards_.emplace_back(*set, forest, layout);
}

}  // namespace vesalius
