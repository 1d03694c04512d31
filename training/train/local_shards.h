#pragma once

#include <utility>
#include <vector>

#include "train/growing_tree.h"
#include "train/leaves/leaf_shard.h"
#include "train/messages/training_protocol.h"
#include "train/samples/training_set.h"
#include "train/tree_shard.h"
#include "vesalius/parallel.h"

// Executors whose shards are objects of this process, wherever those keep their samples.
namespace vesalius {

/// Asks all shards one after the other and returns the merged reply.
template <class Shards, class Ask>
auto merged(Shards& shards, const Ask& ask) {
  auto all = ask(shards.front());
  for (std::size_t i = 1; i < shards.size(); ++i) merge(all, ask(shards[i]));
  return all;
}

/// The shards of one tree; there is at least one. Requests about a batch go to one shard after the other on the calling
/// thread, those that take long to all shards at once. A Shard has the functions of TreeShard.
template <class Shard>
class ShardedTree : public TreeExecutor {
 public:
  SampleCounts sample_counts() override {
    return merged(shards_, [](const Shard& shard) { return shard.sample_counts(); });
  }
  void open_level(const Level& level) override {
    std::vector<ChildSizes> before{ChildSizes(level.node_of_child.size(), 0)};
    for (const Shard& shard : shards_) {
      before.push_back(before.back());
      merge(before.back(), shard.child_sizes());
    }
    for_all([&](int i) { shards_[i].open_level(level, before[i]); });
  }
  void evaluate(NodeRange group, int block) override {
    for_all([&](int i) { shards_[i].evaluate(group, block); });
  }
  std::vector<NodeValues> node_values(NodeRange batch) override {
    return merged(shards_, [&](const Shard& shard) { return shard.node_values(batch); });
  }
  std::vector<SplitHistogram> histograms(NodeRange batch, const std::vector<CountTask>& tasks) override {
    return merged(shards_, [&](const Shard& shard) { return shard.histograms(batch, tasks); });
  }
  std::vector<IntervalValues> values_in(const std::vector<ValueInterval>& intervals) override {
    return merged(shards_, [&](const Shard& shard) { return shard.values_in(intervals); });
  }
  void set_splits(const std::vector<NodeSplit>& splits) override {
    for (Shard& shard : shards_) shard.set_splits(splits);
  }
  ChildCounts route() override {
    std::vector<ChildCounts> replies(shards_.size());
    for_all([&](int i) { replies[i] = shards_[i].route(); });
    return merged(replies, [](ChildCounts& reply) { return std::move(reply); });
  }

 protected:
  std::vector<Shard> shards_;

 private:
  template <class Work>
  void for_all(const Work& work) {
    parallel_for(int(shards_.size()), work);
  }
};

/// The shards of learning leaves, asked one after the other. A Shard has the functions of LeafShard.
template <class Shard>
class ShardedLeaves : public LeafExecutor {
 public:
  LabelCounts label_counts() override {
    return merged(shards_, [](const Shard& shard) { return shard.label_counts(); });
  }
  void set_weights(const SampleWeights& weights) override {
    for (Shard& shard : shards_) shard.set_weights(weights);
  }
  LeafCounts leaf_counts(int tree) override {
    return merged(shards_, [&](const Shard& shard) { return shard.leaf_counts(tree); });
  }
  LeafGradient gradient(const LeafLogits& logits, const GradientTask& task) override {
    return merged(shards_, [&](const Shard& shard) { return shard.gradient(logits, task); });
  }

 protected:
  std::vector<Shard> shards_;
};

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
