#pragma once

#include <vector>

#include "train/growing_tree.h"
#include "train/leaf_shard.h"
#include "train/training_protocol.h"
#include "train/training_set.h"
#include "train/tree_shard.h"

namespace vesalius {

/// The shards of one tree within this process. Requests about a batch go to one shard after the other on the calling
/// thread; all others go to all shards at once, each on all allowed threads.
class LocalTree : public TreeExecutor {
 public:
  /// Makes one shard for each set, in the order of their frames; there is at least one. The sets must outlive this
  /// object and not change.
  LocalTree(const std::vector<const TrainingSet*>& sets, const GrowTreeOptions& options, int tree);

  SampleCounts sample_counts() override;
  void open_level(const Level& level) override;
  void evaluate(NodeRange group, int block) override;
  std::vector<NodeValues> node_values(NodeRange batch) override;
  std::vector<SplitHistogram> histograms(NodeRange batch, const std::vector<CountTask>& tasks) override;
  std::vector<IntervalValues> values_in(const std::vector<ValueInterval>& intervals) override;
  void set_splits(const std::vector<NodeSplit>& splits) override;
  ChildCounts route() override;
  /// Instead of all levels above: moves the samples to the children that they reach in `tree`, and counts them.
  ChildCounts walk_to(const OpenTree& tree);

 private:
  std::vector<TreeShard> shards_;
};

/// The shards of learning leaves within this process, asked one after the other; each uses all allowed threads.
class LocalLeaves : public LeafExecutor {
 public:
  /// As LocalTree.
  LocalLeaves(const std::vector<const TrainingSet*>& sets, const Forest& forest, const LogitLayout& layout);

  LabelCounts label_counts() override;
  void set_weights(const SampleWeights& weights) override;
  LeafCounts leaf_counts(int tree) override;
  LeafGradient gradient(const LeafLogits& logits, const GradientTask& task) override;

 private:
  std::vector<LeafShard> shards_;
};

}  // namespace vesalius
