#pragma once

#include <memory>
#include <vector>

#include "train/training_protocol.h"
#include "train/training_set.h"
#include "train/tree_shard.h"

namespace vesalius {

/// Shards within this process, for one tree. Requests about a batch go to one shard after the other on the thread that
/// asks, all others to all shards at once, each on all threads allowed.
class LocalTree : public TreeExecutor {
 public:
  /// One shard of each set, in the order of their frames; at least one. The sets must outlive this and stay as they
  /// are.
  LocalTree(const std::vector<const TrainingSet*>& sets, const GrowTreeOptions& options, int tree);

  SampleCounts sample_counts() override;
  void open_level(const Level& level) override;
  void evaluate(NodeRange group, int block) override;
  std::vector<NodeValues> node_values(NodeRange batch) override;
  std::vector<SplitHistogram> histograms(NodeRange batch, const std::vector<CountTask>& tasks) override;
  std::vector<IntervalValues> values_in(const std::vector<ValueInterval>& intervals) override;
  void set_splits(const std::vector<NodeSplit>& splits) override;
  ChildCounts route() override;

 private:
  std::vector<TreeShard> shards_;
};

/// All shards of a training within this process.
class LocalExecutor : public Executor {
 public:
  /// The sets must outlive this. At least one.
  explicit LocalExecutor(std::vector<TrainingSet*> sets);

  std::unique_ptr<TreeExecutor> begin_tree(const GrowTreeOptions& options, int tree) override;
  HardCounts count_hard_negatives(const Forest& forest) override;
  std::size_t add_hard_negatives(const HardCut& cut) override;

 private:
  std::vector<TrainingSet*> sets_;
  std::vector<HardCounts> hard_;  ///< of each set, as counted last
};

}  // namespace vesalius
