#include "train/local_shards.h"

#include <utility>

#include "vesalius/base/parallel.h"

namespace vesalius {
namespace {

/// Asks all shards one after the other and returns the merged reply.
template <class Shards, class Ask>
auto merged(Shards& shards, const Ask& ask) {
  auto all = ask(shards.front());
  for (std::size_t i = 1; i < shards.size(); ++i) merge(all, ask(shards[i]));
  return all;
}

}  // namespace

LocalTree::LocalTree(const std::vector<const TrainingSet*>& sets, const GrowTreeOptions& options, int tree) {
  shards_.reserve(sets.size());
  for (const TrainingSet* set : sets) shards_.emplace_back(*set, options, tree);
}

SampleCounts LocalTree::sample_counts() {
  return merged(shards_, [](const TreeShard& shard) { return shard.sample_counts(); });
}

void LocalTree::open_level(const Level& level) {
  std::vector<ChildSizes> before{ChildSizes(level.node_of_child.size(), 0)};
  for (const TreeShard& shard : shards_) {
    before.push_back(before.back());
    merge(before.back(), shard.child_sizes());
  }
  parallel_for(static_cast<int>(shards_.size()), [&](int i) { shards_[i].open_level(level, before[i]); });
}

void LocalTree::evaluate(NodeRange group, int block) {
  parallel_for(static_cast<int>(shards_.size()), [&](int i) { shards_[i].evaluate(group, block); });
}

std::vector<NodeValues> LocalTree::node_values(NodeRange batch) {
  return merged(shards_, [&](const TreeShard& shard) { return shard.node_values(batch); });
}

std::vector<SplitHistogram> LocalTree::histograms(NodeRange batch, const std::vector<CountTask>& tasks) {
  return merged(shards_, [&](const TreeShard& shard) { return shard.histograms(batch, tasks); });
}

std::vector<IntervalValues> LocalTree::values_in(const std::vector<ValueInterval>& intervals) {
  return merged(shards_, [&](const TreeShard& shard) { return shard.values_in(intervals); });
}

void LocalTree::set_splits(const std::vector<NodeSplit>& splits) {
  for (TreeShard& shard : shards_) shard.set_splits(splits);
}

ChildCounts LocalTree::route() {
  std::vector<ChildCounts> replies(shards_.size());
  parallel_for(static_cast<int>(shards_.size()), [&](int i) { replies[i] = shards_[i].route(); });
  return merged(replies, [](ChildCounts& reply) { return std::move(reply); });
}

ChildCounts LocalTree::walk_to(const OpenTree& tree) {
  return merged(shards_, [&](TreeShard& shard) { return shard.walk_to(tree); });
}

LocalLeaves::LocalLeaves(const std::vector<const TrainingSet*>& sets, const Forest& forest, const LogitLayout& layout) {
  for (const TrainingSet* set : sets) shards_.emplace_back(*set, forest, layout);
}

LabelCounts LocalLeaves::label_counts() {
  return merged(shards_, [](const LeafShard& shard) { return shard.label_counts(); });
}

void LocalLeaves::set_weights(const SampleWeights& weights) {
  for (LeafShard& shard : shards_) shard.set_weights(weights);
}

LeafCounts LocalLeaves::leaf_counts(int tree) {
  return merged(shards_, [&](const LeafShard& shard) { return shard.leaf_counts(tree); });
}

LeafGradient LocalLeaves::gradient(const LeafLogits& logits, const GradientTask& task) {
  return merged(shards_, [&](const LeafShard& shard) { return shard.gradient(logits, task); });
}

}  // namespace vesalius
