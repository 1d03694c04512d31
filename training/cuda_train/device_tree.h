#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "cuda_train/device_samples.h"
#include "train/local_shards.h"
#include "train/messages/grow_options.h"
#include "train/messages/training_messages.h"

namespace vesalius::gpu {

/// One shard's part in growing one tree, as TreeShard, with samples, rows and histograms on a device. Requests come one
/// at a time.
class DeviceTreeShard {
 public:
  DeviceTreeShard(std::shared_ptr<const DeviceSamples> samples, const GrowTreeOptions& options, int tree);

  SampleCounts sample_counts() const { return samples_->sample_counts(); }
  const ChildSizes& child_sizes() const { return child_sizes_; }
  void open_level(const Level& level, const ChildSizes& before);
  void evaluate(NodeRange group, int block);
  std::vector<NodeValues> node_values(NodeRange batch) const;
  std::vector<SplitHistogram> histograms(NodeRange batch, const std::vector<CountTask>& tasks) const;
  std::vector<BinChoice> best_bins(NodeRange batch, const std::vector<CountTask>& tasks, const std::vector<int>& least,
                                   int candidates, const EntropyTable& entropy) const;
  std::vector<IntervalValues> values_in(const std::vector<ValueInterval>& intervals) const;
  void set_splits(const std::vector<NodeSplit>& splits);
  ChildCounts route();

 private:
  /// A node of the level with this shard's samples.
  struct Node {
    LevelNode all;
    std::int64_t first_rank = 0;
    std::uint32_t begin = 0, size = 0;        ///< in `order_`
    std::int64_t row_begin = 0, row_end = 0;  ///< rows of its counted samples
  };

  /// Memory that requests use; it is kept for the next.
  struct Scratch {
    DeviceArray<RowNode> row_nodes;
    DeviceArray<std::int16_t> offsets, values, low;
    DeviceArray<std::uint16_t> factor;
    DeviceArray<std::uint8_t> labels, class_of;
    DeviceArray<RowChunk> chunks;
    DeviceArray<std::int32_t> negated_low, high, class_counts, totals, below, entropy, node_of_child;
    DeviceArray<CountNode> count_nodes;
    DeviceArray<std::uint32_t> counts, children, of_block, next_order, found_count;
    DeviceArray<BestOfNode> best;
    DeviceArray<Interval> intervals;
    DeviceArray<CollectedValue> found;
    DeviceArray<MoveNode> moves;
    DeviceArray<PlainNode> splits;
  };

  std::int64_t first_row() const { return level_[group_.begin].row_begin; }
  /// Divides the rows of nodes among blocks.
  std::vector<RowChunk> chunks_of(const std::vector<std::int32_t>& nodes) const;
  std::vector<RowChunk> chunks_of(NodeRange batch) const;
  Rows rows() const;
  /// Counts the batch's rows in bins; returns where each node's counts are.
  std::vector<CountNode> count(NodeRange batch, const std::vector<CountTask>& tasks,
                               const std::vector<int>& least) const;
  void move_samples(const ChildCounts& children);

  std::shared_ptr<const DeviceSamples> samples_;
  GrowTreeOptions options_;
  int tree_;
  ChildSizes child_sizes_;
  std::vector<std::uint32_t> child_begin_;  ///< in `order_`
  std::vector<Node> level_;
  std::vector<PlainNode> splits_;  ///< [node of the level]
  NodeRange group_;
  NodeRange rows_of_{0, 0};  ///< nodes whose rows are known
  int padded_ = 0;

  DeviceArray<std::uint32_t> order_, row_of_;
  DeviceArray<std::int32_t> node_of_;
  mutable Scratch scratch_;
  TrainStream stream_;  // the last: it ends before the memory that it uses
};

/// The shards of one tree, each on a device.
class DeviceTree : public ShardedTree<DeviceTreeShard> {
 public:
  /// Makes one shard for each; there is at least one.
  DeviceTree(const std::vector<std::shared_ptr<const DeviceSamples>>& samples, const GrowTreeOptions& options,
             int tree);
  /// Chosen on the device where there is only one shard.
  std::vector<BinChoice> best_bins(NodeRange batch, const std::vector<CountTask>& tasks, const std::vector<int>& least,
                                   int candidates, const EntropyTable& entropy) override;
};

}  // namespace vesalius::gpu
