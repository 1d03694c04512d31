#include "train/grow_tree.h"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include "train/growing_tree.h"
#include "train/local_shards.h"
#include "train/split_candidates.h"
#include "train/split_histogram.h"
#include "vesalius/base/options.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

/// Bytes of a shard's values of one counted sample.
constexpr std::int64_t kRowBytes = sizeof(std::int16_t) * kBlockCandidates;

/// Grows a tree level by level from the shards' replies.
class TreeDriver {
 public:
  TreeDriver(TreeExecutor& shards, const Forest& forest, const GrowTreeOptions& options, int tree,
             const SampleCounts& samples, GrowProgress& progress)
      : shards_(shards),
        convention_(forest.convention),
        options_(options),
        tree_(tree),
        progress_(progress),
        grown_(samples, forest.body.part_count(), options) {}

  /// Grows from roots to which the shards' samples have come as children of no level.
  const GrowingTree& grow(std::span<const TreeRoot> roots) {
    std::vector<std::int32_t> node_of_child = grown_.begin(roots);
    tell_progress();
    while (!grown_.level().empty()) {
      open_level(std::move(node_of_child));
      for (const NodeRange& group : groups()) choose_splits(group);
      node_of_child = grown_.descend(shards_.route());
      tell_progress();
    }
    return grown_;
  }

 private:
  void tell_progress() {
    progress_.settled += static_cast<std::uint64_t>(grown_.settled() - told_settled_);
    progress_.nodes += static_cast<std::uint64_t>(grown_.split_nodes() - told_nodes_);
    told_settled_ = grown_.settled();
    told_nodes_ = grown_.split_nodes();
  }

  void open_level(std::vector<std::int32_t> node_of_child) {
    Level level{std::move(node_of_child), {}};
    for (const OpenNode& open : grown_.level()) level.nodes.push_back(open.node);
    shards_.open_level(level);
  }

  std::vector<NodeRange> groups() const {
    const auto bytes_of = [&](std::int32_t n) { return grown_.level()[n].node.counted * kRowBytes; };
    return node_runs({0, static_cast<std::int32_t>(grown_.level().size())},
                     static_cast<std::int64_t>(options_.row_bytes), bytes_of);
  }

  std::vector<NodeRange> batches(NodeRange group) const {
    const auto bytes_of = [&](std::int32_t n) {
      const OpenNode& open = grown_.level()[n];
      return (open.node.counted + open.classes * bins_of(open)) * kRowBytes;
    };
    return node_runs(group, static_cast<std::int64_t>(options_.batch_bytes), bytes_of);
  }

  int bins_of(const OpenNode& open) const { return bins_for(open.node.counted, options_.split.bins); }

  void choose_splits(NodeRange group) {
    const std::vector<NodeRange> all = batches(group);
    std::int64_t counted = 0;
    for (std::int32_t n = group.begin; n < group.end; ++n) counted += grown_.level()[n].node.counted;
    for (int block = 0; block < candidate_blocks(options_.split); ++block) {
      if (progress_.stop) throw Interrupted("training: interrupted");
      shards_.evaluate(group, block);
      parallel_for(int(all.size()), [&](int i) { choose_splits(all[i], block); });
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
      tasks.push_back({{of_node.ranges, bins_of(grown_.level()[n])}, ClassIndex(of_node.class_counts)});
    }
    std::vector<int> least;
    for (std::int32_t n = batch.begin; n < batch.end; ++n) {
      least.push_back(least_samples(grown_.level()[n].node, options_.leaf));
    }
    const std::vector<BinChoice> best =
        shards_.best_bins(batch, tasks, least, block_candidates(options_.split, block), entropy_);
    std::vector<ValueInterval> intervals;
    for (std::int32_t n = batch.begin; n < batch.end; ++n) {
      const int i = n - batch.begin;
      if (best[i].split.candidate >= 0) intervals.push_back(beside(best[i].split, tasks[i].binning, n));
    }
    if (intervals.empty()) return;
    std::vector<IntervalValues> beside_split = shards_.values_in(intervals);
    std::vector<NodeSplit> splits;
    for (std::size_t f = 0; f < intervals.size(); ++f) {
      const std::int32_t node = intervals[f].node;
      const int i = node - batch.begin;
      const OpenNode& open = grown_.level()[node];
      const int candidate = best[i].split.candidate;
      const ThresholdSplit refined =
          refine_split(std::move(beside_split[f]), best[i], tasks[i].classes, least[i], entropy_);
      TreeNode split = node_candidates(convention_, options_, tree_, open.node.number, block).node(candidate);
      split.threshold_mm = static_cast<std::int16_t>(refined.threshold_mm);
      if (grown_.offer(node, split, refined.gain)) splits.push_back({node, candidate, split});
    }
    if (!splits.empty()) shards_.set_splits(splits);
  }

  TreeExecutor& shards_;
  const FeatureConvention& convention_;
  const GrowTreeOptions& options_;
  int tree_;
  GrowProgress& progress_;
  GrowingTree grown_;
  EntropyTable entropy_;
  std::int64_t told_settled_ = 0, told_nodes_ = 0;
};

}  // namespace

std::vector<BinChoice> TreeExecutor::best_bins(NodeRange batch, const std::vector<CountTask>& tasks,
                                               const std::vector<int>& least, int candidates,
                                               const EntropyTable& entropy) {
  const std::vector<SplitHistogram> counts = histograms(batch, tasks);
  std::vector<BinChoice> best;
  best.reserve(counts.size());
  for (std::size_t i = 0; i < counts.size(); ++i) {
    best.push_back(choose_bin(counts[i], candidates, tasks[i].classes, least[i], entropy));
  }
  return best;
}

Tree grow_tree(TreeExecutor& shards, const Forest& forest, const GrowTreeOptions& options, int tree,
               GrowProgress& progress) {
  const SampleCounts samples = shards.sample_counts();
  const TreeRoot root{1, samples.samples};
  return pruned_tree(grow_subtrees(shards, forest, options, tree, samples, {&root, 1}, progress).front());
}

std::vector<std::vector<GrownNode>> grow_subtrees(TreeExecutor& shards, const Forest& forest,
                                                  const GrowTreeOptions& options, int tree, const SampleCounts& samples,
                                                  std::span<const TreeRoot> roots, GrowProgress& progress) {
  GrowTreeOptions checked = options;
  RangeCheck range;
  visit_options("", checked, range);
  if (std::ranges::all_of(samples.samples, [](std::int64_t n) { return n == 0; })) {
    throw Error("training: no pixel with a label and a reading in any frame");
  }
  TreeDriver driver(shards, forest, checked, tree, samples, progress);
  const GrowingTree& grown = driver.grow(roots);
  std::vector<std::vector<GrownNode>> subtrees;
  for (std::size_t i = 0; i < roots.size(); ++i) subtrees.push_back(grown.subtree(i));
  return subtrees;
}

Tree grow_tree(const TrainingSet& set, const GrowTreeOptions& options, int tree, GrowProgress* progress) {
  GrowProgress unseen;
  LocalTree shards({&set}, options, tree);
  return grow_tree(shards, set.untrained_forest(), options, tree, progress != nullptr ? *progress : unseen);
}

}  // namespace vesalius
