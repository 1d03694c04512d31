#include "train/grow_tree.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "train/leaf_shares.h"
#include "train/local_executor.h"
#include "train/prune_tree.h"
#include "train/split_candidates.h"
#include "train/split_histogram.h"
#include "vesalius/base/options.h"
#include "vesalius/base/parallel.h"

namespace vesalius {
namespace {

/// A node of the current level.
struct OpenNode {
  LevelNode node;
  std::size_t at = 0;  ///< index in the tree
  int classes = 0;     ///< number of its samples' classes
  TreeNode split;
  double gain = 0;  ///< bits per sample; 0 if no split was found
};

/// Bytes of a shard's values of one counted sample.
constexpr std::int64_t kRowBytes = sizeof(std::int16_t) * kBlockCandidates;

/// Grows a tree level by level from the shards' replies.
class TreeDriver {
 public:
  TreeDriver(TreeExecutor& shards, const Forest& forest, const GrowTreeOptions& options, int tree,
             GrowProgress& progress)
      : shards_(shards),
        convention_(forest.convention),
        options_(options),
        tree_(tree),
        progress_(progress),
        samples_(shards.sample_counts()),
        leaves_(samples_, forest.body.part_count(), options.leaf) {}

  Tree grow() {
    if (std::ranges::all_of(samples_.samples, [](std::int64_t n) { return n == 0; })) {
      throw Error("training: no pixel with a label and a reading in any frame");
    }
    built_.emplace_back();
    std::vector<std::int32_t> node_of_child{open_or_settle(1, 0, samples_.samples.data(), 0)};
    for (int depth = 0; !level_.empty(); ++depth) {
      open_level(std::move(node_of_child));
      for (const NodeRange& group : groups()) choose_splits(group);
      node_of_child = descend(shards_.route(), depth + 1);
    }
    return pruned_tree(built_);
  }

 private:
  /// Makes a node of the next level, or a leaf if no split is possible. Returns the node's index or kSettled.
  std::int32_t open_or_settle(std::uint32_t number, std::size_t at, const std::int64_t* counts, int depth) {
    const std::size_t classes = samples_.samples.size();
    const std::int64_t size = std::accumulate(counts, counts + classes, std::int64_t{0});
    const auto present = static_cast<int>(std::count_if(counts, counts + classes, [](auto n) { return n > 0; }));
    built_[at].leaf = leaves_.leaf(counts);
    if (depth >= options_.leaf.max_depth || present < 2 || size < 2 * options_.leaf.min_samples) {
      settle(size, depth);
      return kSettled;
    }
    OpenNode open;
    open.node = {number, size, std::min<std::int64_t>(size, options_.split.split_pixels)};
    open.at = at;
    open.classes = present;
    level_.push_back(open);
    return static_cast<std::int32_t>(level_.size() - 1);
  }

  void settle(std::int64_t size, int depth) {
    progress_.settled += static_cast<std::uint64_t>(size * (options_.leaf.max_depth - depth));
  }

  void open_level(std::vector<std::int32_t> node_of_child) {
    Level level{std::move(node_of_child), {}};
    for (const OpenNode& open : level_) level.nodes.push_back(open.node);
    shards_.open_level(level);
  }

  /// Splits a range of nodes into runs of at most `most` bytes, but at least one node each.
  template <class BytesOf>
  std::vector<NodeRange> runs(NodeRange nodes, std::size_t most, const BytesOf& bytes_of) const {
    std::vector<NodeRange> runs;
    std::int64_t bytes = 0;
    for (std::int32_t n = nodes.begin; n < nodes.end; ++n) {
      const std::int64_t more = bytes_of(level_[n]);
      if (runs.empty() || bytes + more > static_cast<std::int64_t>(most)) {
        runs.push_back({n, n});
        bytes = 0;
      }
      runs.back().end = n + 1;
      bytes += more;
    }
    return runs;
  }

  std::vector<NodeRange> groups() const {
    return runs({0, static_cast<std::int32_t>(level_.size())}, options_.row_bytes,
                [](const OpenNode& open) { return open.node.counted * kRowBytes; });
  }

  std::vector<NodeRange> batches(NodeRange group) const {
    return runs(group, options_.batch_bytes,
                [&](const OpenNode& open) { return (open.node.counted + open.classes * bins_of(open)) * kRowBytes; });
  }

  int bins_of(const OpenNode& open) const { return bins_for(open.node.counted, options_.split.bins); }

  void choose_splits(NodeRange group) {
    const std::vector<NodeRange> all = batches(group);
    std::int64_t counted = 0;
    for (std::int32_t n = group.begin; n < group.end; ++n) counted += level_[n].node.counted;
    for (int block = 0; block < candidate_blocks(options_.split); ++block) {
      if (progress_.stop) throw Interrupted("training: interrupted");
      shards_.evaluate(group, block);
      parallel_for(static_cast<int>(all.size()), [&](int i) { choose_splits(all[i], block); });
      progress_.evaluations += static_cast<std::uint64_t>(counted * block_candidates(options_.split, block));
    }
  }

  /// Asks for the best split of each node of a batch among the candidates of one block, and tells the shards of those
  /// that are better than the splits of earlier blocks.
  void choose_splits(NodeRange batch, int block) {
    std::vector<CountTask> tasks;
    const std::vector<NodeValues> values = shards_.node_values(batch);
    for (std::int32_t n = batch.begin; n < batch.end; ++n) {
      const NodeValues& of_node = values[n - batch.begin];
      tasks.push_back({{of_node.ranges, bins_of(level_[n])}, ClassIndex(of_node.class_counts)});
    }
    const std::vector<SplitHistogram> histograms = shards_.histograms(batch, tasks);
    std::vector<BinSplit> found;
    std::vector<ValueInterval> intervals;
    for (std::int32_t n = batch.begin; n < batch.end; ++n) {
      const int i = n - batch.begin;
      const BinSplit best = best_split(histograms[i], block_candidates(options_.split, block), tasks[i].classes,
                                       least_samples(level_[n]), entropy_);
      if (best.candidate < 0) continue;
      found.push_back(best);
      intervals.push_back(beside(best, tasks[i].binning, n));
    }
    if (found.empty()) return;
    std::vector<IntervalValues> beside_split = shards_.values_in(intervals);
    std::vector<NodeSplit> splits;
    for (std::size_t f = 0; f < found.size(); ++f) {
      OpenNode& open = level_[intervals[f].node];
      const int i = intervals[f].node - batch.begin;
      const ThresholdSplit refined = refine_split(std::move(beside_split[f]), found[f], histograms[i], tasks[i].classes,
                                                  least_samples(open), entropy_);
      if (refined.gain < static_cast<double>(options_.split.min_gain) || refined.gain <= open.gain) continue;
      open.gain = refined.gain;
      open.split = node_candidates(convention_, options_, tree_, open.node.number, block).node(found[f].candidate);
      open.split.threshold_mm = static_cast<std::int16_t>(refined.threshold_mm);
      splits.push_back({intervals[f].node, found[f].candidate, open.split});
    }
    if (!splits.empty()) shards_.set_splits(splits);
  }

  /// Returns the smallest number of counted samples on a side at which about `min_samples` of all samples go there.
  int least_samples(const OpenNode& open) const {
    const LevelNode& node = open.node;
    return static_cast<int>((options_.leaf.min_samples * node.counted + node.size - 1) / node.size);
  }

  /// Makes the children, which become the next level. Returns for each child its index there or kSettled.
  std::vector<std::int32_t> descend(const ChildCounts& children, int depth) {
    const std::vector<OpenNode> parents = std::exchange(level_, {});
    std::vector<std::int32_t> node_of_child(2 * parents.size(), kSettled);
    for (std::size_t n = 0; n < parents.size(); ++n) {
      const OpenNode& parent = parents[n];
      if (parent.gain <= 0.0) {
        settle(parent.node.size, depth - 1);
        continue;
      }
      progress_.settled += static_cast<std::uint64_t>(parent.node.size);
      ++progress_.nodes;
      const std::size_t left = built_.size();
      built_[parent.at].split = parent.split;
      built_[parent.at].left = left;
      built_[parent.at].right = left + 1;
      built_.resize(built_.size() + 2);
      for (std::uint32_t side = 0; side < 2; ++side) {
        const std::size_t child = 2 * n + side;
        node_of_child[child] = open_or_settle(2 * parent.node.number + side, left + side, children.of(child), depth);
      }
    }
    return node_of_child;
  }

  TreeExecutor& shards_;
  const FeatureConvention& convention_;
  const GrowTreeOptions& options_;
  int tree_;
  GrowProgress& progress_;
  SampleCounts samples_;
  LeafShares leaves_;
  EntropyTable entropy_;
  std::vector<OpenNode> level_;
  std::vector<GrownNode> built_;
};

}  // namespace

Tree grow_tree(TreeExecutor& shards, const Forest& forest, const GrowTreeOptions& options, int tree,
               GrowProgress& progress) {
  GrowTreeOptions checked = options;
  RangeCheck range;
  visit_options("", checked, range);
  return TreeDriver(shards, forest, checked, tree, progress).grow();
}

Tree grow_tree(const TrainingSet& set, const GrowTreeOptions& options, int tree, GrowProgress* progress) {
  GrowProgress unseen;
  LocalTree shards({&set}, options, tree);
  return grow_tree(shards, set.untrained_forest(), options, tree, progress != nullptr ? *progress : unseen);
}

}  // namespace vesalius
