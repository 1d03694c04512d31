#include "train/tree_shard.h"

#include <algorithm>
#include <limits>

#include "train/samples/frame_store.h"
#include "train/samples/walk_samples.h"
#include "train/split_candidates.h"
#include "train/split_histogram.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

constexpr std::uint32_t kNoRow = std::numeric_limits<std::uint32_t>::max();
constexpr int kGrain = 8192;       ///< samples that a thread takes at a time
constexpr std::size_t kAhead = 3;  ///< number of samples whose table and row are prefetched
/// Numbers of samples of a frame from which unpacking all of it is worthwhile: if all candidates are computed, and if
/// one feature is.
constexpr double kFewEvaluated = 12.0, kFewRouted = 150.0;

/// Prefetches memory. Neighbouring samples are in unrelated nodes, so each would otherwise wait for its node's table
/// and row.
void prefetch_lines(const void* from, std::size_t bytes) {
  const char* at = static_cast<const char*>(from);
  for (std::size_t i = 0; i < bytes; i += kLineBytes) __builtin_prefetch(at + i, 0, 3);
}

}  // namespace

TreeShard::TreeShard(const TrainingSet& set, const GrowTreeOptions& options, int tree)
    : set_(set),
      samples_(set.samples()),
      options_(options),
      tree_(tree),
      child_sizes_{static_cast<std::int64_t>(samples_.size())},
      node_of_(samples_.size(), 0),
      row_of_(samples_.size(), kNoRow),
      on_right_(samples_.size(), 0) {}

void TreeShard::open_level(const Level& level, const ChildSizes& before) {
  level_.assign(level.nodes.size(), {});
  for (std::size_t n = 0; n < level_.size(); ++n) level_[n].all = level.nodes[n];
  std::int64_t row = 0;
  for (std::size_t child = 0; child < level.node_of_child.size(); ++child) {
    if (level.node_of_child[child] == kSettled) continue;
    Node& node = level_[level.node_of_child[child]];
    node.size = child_sizes_[child];
    node.first_rank = before[child];
    node.row_begin = row;
    row += node.all.counted_before(before[child] + node.size) - node.all.counted_before(before[child]);
    node.row_end = row;
  }
  for (std::size_t s = 0; s < samples_.size(); ++s) {
    if (node_of_[s] != kSettled) node_of_[s] = level.node_of_child[node_of_[s]];
  }
  assign_rows();
}

/// Gives a row to every counted sample. The rows of a node are consecutive.
void TreeShard::assign_rows() {
  std::vector<std::int64_t> ranks(level_.size());
  std::ranges::transform(level_, ranks.begin(), &Node::first_rank);
  for (std::size_t s = 0; s < samples_.size(); ++s) {
    row_of_[s] = kNoRow;
    if (node_of_[s] == kSettled) continue;
    const Node& node = level_[node_of_[s]];
    const std::int64_t rank = ranks[node_of_[s]]++;
    const std::int64_t before = node.all.counted_before(rank);
    if (node.all.counted_before(rank + 1) == before) continue;
    row_of_[s] = static_cast<std::uint32_t>(node.row_begin + before - node.all.counted_before(node.first_rank));
  }
}

void TreeShard::evaluate(NodeRange group, int block) {
  group_ = group;
  draw_tables(block);
  const std::int64_t first_row = level_[group.begin].row_begin;
  const std::size_t rows = level_[group.end - 1].row_end - first_row;
  const std::size_t bytes = rows * tables_.padded * sizeof(std::int16_t);
  if (values_.size() < bytes) values_ = HugeBuffer(bytes);
  row_labels_.resize(rows);
  row_samples_.resize(rows);
  evaluate_rows(rows);
}

/// Draws the candidates of one block for every node of the group.
void TreeShard::draw_tables(int block) {
  const auto draw = [&](std::int32_t node) {
    return node_candidates(set_.convention(), options_, tree_, level_[node].all.number, block);
  };
  tables_.padded = draw(group_.begin).padded;
  tables_.offsets.resize(group_.size() * tables_.length());
  parallel_for(group_.size(), [&](int i) {
    std::ranges::copy(draw(group_.begin + i).offsets, tables_.offsets.data() + i * tables_.length());
  });
}

/// Computes the `rows` rows of the group.
void TreeShard::evaluate_rows(std::size_t rows) {
  const FrameStore& frames = set_.frames();
  const std::size_t first_row = level_[group_.begin].row_begin;
  const bool few = double(rows) < kFewEvaluated * double(frames.size());
  const auto has_row = [&](std::size_t s) {
    return row_of_[s] != kNoRow && row_of_[s] >= first_row && row_of_[s] < first_row + rows;
  };
  const auto row_at = [&](std::size_t s) { return row_of_[s] - first_row; };
  const auto values_at = [&](std::size_t s) { return values() + row_at(s) * tables_.padded; };
  const auto table_at = [&](std::size_t s) {
    return tables_.offsets.data() + (node_of_[s] - group_.begin) * tables_.length();
  };
  parallel_ranges(int(samples_.size()), kGrain, [&](int begin, int end) {
    FramePrefetcher prefetcher(frames, samples_);
    FrameUnpacker unpack(frames);
    for (auto s = static_cast<std::size_t>(begin); s < static_cast<std::size_t>(end); ++s) {
      if (!few) prefetcher.step(s);
      const std::size_t later = s + kAhead;
      if (later < static_cast<std::size_t>(end) && has_row(later)) {
        prefetch_lines(table_at(later), tables_.length() * sizeof(std::int16_t));
        prefetch_lines(values_at(later), tables_.padded * sizeof(std::int16_t));
      }
      if (!has_row(s)) continue;
      const TrainingSample& sample = samples_[s];
      const auto evaluate_on = [&](const auto& depth) {
        evaluate_candidates(depth, set_.convention(), sample, table_at(s), tables_.padded, values_at(s));
      };
      if (few) {
        evaluate_on(frames[sample.frame]);
      } else {
        evaluate_on(unpack(sample.frame));
      }
      row_labels_[row_at(s)] = sample.label;
      row_samples_[row_at(s)] = static_cast<std::uint32_t>(s);
    }
  });
}

FeatureRows TreeShard::rows_of(const Node& node) const {
  const std::int64_t begin = node.row_begin - level_[group_.begin].row_begin;
  return {values() + begin * tables_.padded, row_labels_.data() + begin,
          static_cast<std::size_t>(node.row_end - node.row_begin), tables_.padded};
}

std::vector<NodeValues> TreeShard::node_values(NodeRange batch) const {
  std::vector<NodeValues> values;
  values.reserve(batch.size());
  for (int n = batch.begin; n < batch.end; ++n) {
    values.push_back(vesalius::node_values(rows_of(level_[n]), set_.class_count()));
  }
  return values;
}

std::vector<SplitHistogram> TreeShard::histograms(NodeRange batch, const std::vector<CountTask>& tasks) const {
  std::vector<SplitHistogram> histograms;
  histograms.reserve(batch.size());
  for (int n = batch.begin; n < batch.end; ++n) {
    histograms.push_back(count_bins(rows_of(level_[n]), tasks[n - batch.begin]));
  }
  return histograms;
}

std::vector<IntervalValues> TreeShard::values_in(const std::vector<ValueInterval>& intervals) const {
  std::vector<IntervalValues> values;
  values.reserve(intervals.size());
  for (const ValueInterval& interval : intervals) {
    values.push_back(vesalius::values_in(rows_of(level_[interval.node]), interval));
  }
  return values;
}

void TreeShard::set_splits(const std::vector<NodeSplit>& splits) {
  for (const NodeSplit& split : splits) {
    Node& node = level_[split.node];
    node.split = split.split;
    node.divided = true;
    const bool final_and_complete = candidate_blocks(options_.split) == 1 && node.all.counted == node.all.size;
    if (final_and_complete) route_by_rows(node, split.candidate);
  }
}

/// Sends the samples of a node to a side by the present rows.
void TreeShard::route_by_rows(Node& node, int candidate) {
  const FeatureRows rows = rows_of(node);
  const std::uint32_t* sample = row_samples_.data() + (node.row_begin - level_[group_.begin].row_begin);
  const std::int16_t* value = rows.values + candidate;
  for (std::size_t r = 0; r < rows.rows; ++r, value += rows.width) {
    on_right_[sample[r]] = *value > node.split.threshold_mm ? 1 : 0;
  }
  node.routed = true;
}

/// Does the same for nodes of which only some samples have rows.
void TreeShard::route_the_rest() {
  const auto unrouted = [](const Node& node) { return node.divided && !node.routed; };
  std::int64_t samples = 0;
  for (const Node& node : level_) samples += unrouted(node) ? node.size : 0;
  if (samples == 0) return;
  const FrameStore& frames = set_.frames();
  const bool few = double(samples) < kFewRouted * double(frames.size());
  parallel_ranges(int(samples_.size()), kGrain, [&](int begin, int end) {
    FrameUnpacker unpack(frames);
    for (int s = begin; s < end; ++s) {
      if (node_of_[s] == kSettled || !unrouted(level_[node_of_[s]])) continue;
      const TreeNode& split = level_[node_of_[s]].split;
      const TrainingSample& sample = samples_[s];
      const int value = few ? feature_of(frames[sample.frame], set_.convention(), sample, split)
                            : feature_of(unpack(sample.frame), set_.convention(), sample, split);
      on_right_[s] = value > split.threshold_mm ? 1 : 0;
    }
  });
}

ChildCounts TreeShard::route() {
  route_the_rest();
  ChildCounts children{set_.class_count(), std::vector<std::int64_t>(2 * level_.size() * set_.class_count(), 0)};
  for (std::int32_t& node : node_of_) {
    if (node != kSettled) node = 2 * node + on_right_[&node - node_of_.data()];
  }
  count_children(children);
  return children;
}

ChildCounts TreeShard::walk_to(const OpenTree& tree) {
  return move_to(tree, find_leaves({&tree.tree}, set_.frames(), samples_).front());
}

ChildCounts TreeShard::move_to(const OpenTree& tree, std::span<const std::uint32_t> leaves) {
  for (std::size_t s = 0; s < samples_.size(); ++s) node_of_[s] = tree.child_of_leaf[leaves[s]];
  ChildCounts children{set_.class_count(), std::vector<std::int64_t>(tree.children * set_.class_count(), 0)};
  count_children(children);
  return children;
}

void TreeShard::count_children(ChildCounts& children) {
  for (std::size_t s = 0; s < samples_.size(); ++s) {
    if (node_of_[s] != kSettled) ++children.counts[std::size_t(node_of_[s]) * children.classes + samples_[s].label];
  }
  child_sizes_ = vesalius::child_sizes(children);
}

}  // namespace vesalius
