#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "train/feature_rows.h"
#include "train/growing_tree.h"
#include "train/messages/grow_options.h"
#include "train/messages/training_messages.h"
#include "train/samples/huge_buffer.h"
#include "train/samples/training_set.h"

namespace vesalius {

/// One shard's part in growing one tree: the nodes of its samples, and the rows of the current group. It answers the
/// requests of TreeExecutor (training_protocol.h) for its own samples, under the same names.
///
/// Samples are evaluated in the order of their frames, whatever their node: a frame is read from memory once for all of
/// its samples and stays in the cache meanwhile. The values go to rows ordered by node.
class TreeShard {
 public:
  /// `set` must outlive this object and not change.
  TreeShard(const TrainingSet& set, const GrowTreeOptions& options, int tree);

  SampleCounts sample_counts() const { return set_.sample_counts(); }
  /// The samples of this shard at each child of the current level after `route`; before it, all of them as one child.
  const ChildSizes& child_sizes() const { return child_sizes_; }
  /// `before` are the total child sizes of all shards before this one.
  void open_level(const Level& level, const ChildSizes& before);
  void evaluate(NodeRange group, int block);
  /// Returns the rows of a node of the last evaluated group. They are valid until the next call of `evaluate`.
  FeatureRows rows(std::int32_t node) const { return rows_of(level_[node]); }
  std::vector<NodeValues> node_values(NodeRange batch) const;
  std::vector<SplitHistogram> histograms(NodeRange batch, const std::vector<CountTask>& tasks) const;
  std::vector<IntervalValues> values_in(const std::vector<ValueInterval>& intervals) const;
  void set_splits(const std::vector<NodeSplit>& splits);
  ChildCounts route();
  /// Instead of all levels above: moves each sample to the child that it reaches in `tree`, and counts them.
  ChildCounts walk_to(const OpenTree& tree);
  /// The same, if the leaf of each sample in `tree` is known.
  ChildCounts move_to(const OpenTree& tree, std::span<const std::uint32_t> leaves);

 private:
  /// A node of the level with this shard's samples.
  struct Node {
    LevelNode all;                ///< the node over all shards
    std::int64_t size = 0;        ///< samples of this shard
    std::int64_t first_rank = 0;  ///< rank of the first of them
    std::int64_t row_begin = 0;   ///< first row of this shard's counted samples
    std::int64_t row_end = 0;
    TreeNode split;
    bool divided = false;  ///< whether it has a split
    bool routed = false;   ///< whether the rows give the side of every sample
  };

  /// The candidates of the nodes of a group, one after the other, each with the layout of CandidateTable.
  struct Tables {
    int padded = 0;
    std::vector<std::int16_t> offsets;

    std::size_t length() const { return std::size_t{4} * padded; }
  };

  void assign_rows();
  void draw_tables(int block);
  void evaluate_rows(std::size_t rows);
  std::int16_t* values() const { return reinterpret_cast<std::int16_t*>(values_.data()); }
  FeatureRows rows_of(const Node& node) const;
  void route_by_rows(Node& node, int candidate);
  void route_the_rest();
  void count_children(ChildCounts& children);

  const TrainingSet& set_;
  std::span<const TrainingSample> samples_;
  GrowTreeOptions options_;
  int tree_;
  ChildSizes child_sizes_;  ///< child sizes of this shard at the last level
  std::vector<Node> level_;
  /// [sample]: index in `level_`, or kSettled; between `route` or `walk_to` and `open_level` that of a child.
  std::vector<std::int32_t> node_of_;
  std::vector<std::uint32_t> row_of_;   ///< [sample]
  std::vector<std::uint8_t> on_right_;  ///< [sample]: its side

  // The rows of the current group for one block. Their memory is kept from group to group.
  NodeRange group_;
  Tables tables_;
  HugeBuffer values_{0};
  std::vector<std::uint8_t> row_labels_;
  std::vector<std::uint32_t> row_samples_;
};

}  // namespace vesalius
