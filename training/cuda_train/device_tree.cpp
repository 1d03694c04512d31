#include "cuda_train/device_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

#include "train/split_candidates.h"
#include "vesalius/parallel.h"

namespace vesalius::gpu {
namespace {

constexpr std::uint32_t kChunkRows = 2048;  ///< that a block counts
constexpr int kEvaluatedInBlock = 16;
constexpr std::int32_t kLeast = -32768;  ///< below which no value is, nor a value's negative

static_assert(kMostCandidates == kBlockCandidates);

}  // namespace

DeviceTreeShard::DeviceTreeShard(std::shared_ptr<const DeviceSamples> samples, const GrowTreeOptions& options, int tree)
    : samples_(std::move(samples)),
      options_(options),
      tree_(tree),
      child_sizes_{samples_->describe().count},
      child_begin_{0},
      stream_(samples_->device()) {
  const std::uint32_t count = samples_->describe().count;
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  stream_.send(order_, order);
  stream_.clear(node_of_, count);
  stream_->wait();
}

void DeviceTreeShard::open_level(const Level& level, const ChildSizes& before) {
  level_.assign(level.nodes.size(), {});
  splits_.assign(level.nodes.size(), {});
  rows_of_ = {0, 0};
  for (std::size_t n = 0; n < level_.size(); ++n) level_[n].all = level.nodes[n];
  std::int64_t row = 0;
  for (std::size_t child = 0; child < level.node_of_child.size(); ++child) {
    if (level.node_of_child[child] == kSettled) continue;
    Node& node = level_[level.node_of_child[child]];
    node.begin = child_begin_[child];
    node.size = static_cast<std::uint32_t>(child_sizes_[child]);
    node.first_rank = before[child];
    node.row_begin = row;
    row += node.all.counted_before(before[child] + node.size) - node.all.counted_before(before[child]);
    node.row_end = row;
  }
  const std::uint32_t count = samples_->describe().count;
  stream_.send(scratch_.node_of_child, level.node_of_child);
  stream_.launch(RelabelArguments{node_of_.data(), scratch_.node_of_child.data(), count}, count);
  stream_->wait();
}

void DeviceTreeShard::evaluate(NodeRange group, int block) {
  group_ = group;
  const auto rows = static_cast<std::uint32_t>(level_[group.end - 1].row_end - first_row());
  const Samples samples = samples_->describe();
  std::vector<RowNode> row_nodes;
  if (rows_of_.begin != group.begin || rows_of_.end != group.end) {
    for (std::int32_t n = group.begin; n < group.end; ++n) {
      const Node& node = level_[n];
      row_nodes.push_back({node.first_rank, node.all.size, node.all.counted, node.begin,
                           static_cast<std::uint32_t>(node.row_begin - first_row())});
    }
    stream_.send(scratch_.row_nodes, row_nodes);
    stream_.clear(row_of_, samples.count);
    stream_.fit(scratch_.labels, rows);
    stream_.launch(RowsArguments{scratch_.row_nodes.data(), group.size(), rows, order_.data(), samples, row_of_.data(),
                                 scratch_.labels.data()},
                   rows);
    rows_of_ = group;
  }
  const auto draw = [&](std::int32_t node) {
    return node_candidates(samples_->set().convention(), options_, tree_, level_[node].all.number, block);
  };
  padded_ = draw(group.begin).padded;
  const std::size_t length = std::size_t{4} * padded_;
  std::vector<std::int16_t> offsets(group.size() * length);
  parallel_for(group.size(),
               [&](int i) { std::ranges::copy(draw(group.begin + i).offsets, offsets.data() + i * length); });
  stream_.send(scratch_.offsets, offsets);
  stream_.fit(scratch_.values, std::size_t{rows} * padded_);
  EvaluateArguments evaluate{samples_->frames(), samples, row_of_.data(), node_of_.data(), group.begin};
  evaluate.offsets = scratch_.offsets.data();
  evaluate.padded = padded_;
  evaluate.samples_in_block = kEvaluatedInBlock;
  evaluate.values = scratch_.values.data();
  if (rows > 0) stream_.launch_blocks(evaluate, (samples.count + kEvaluatedInBlock - 1) / kEvaluatedInBlock);
  stream_->wait();
}

std::vector<RowChunk> DeviceTreeShard::chunks_of(const std::vector<std::int32_t>& nodes) const {
  std::vector<RowChunk> chunks;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Node& node = level_[nodes[i]];
    for (std::int64_t row = node.row_begin; row < node.row_end; row += kChunkRows) {
      chunks.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(row - first_row()),
                        static_cast<std::uint32_t>(std::min<std::int64_t>(kChunkRows, node.row_end - row))});
    }
  }
  return chunks;
}

std::vector<RowChunk> DeviceTreeShard::chunks_of(NodeRange batch) const {
  std::vector<std::int32_t> nodes(batch.size());
  std::iota(nodes.begin(), nodes.end(), batch.begin);
  return chunks_of(nodes);
}

Rows DeviceTreeShard::rows() const {
  return {scratch_.chunks.data(), scratch_.values.data(), scratch_.labels.data(), padded_};
}

std::vector<NodeValues> DeviceTreeShard::node_values(NodeRange batch) const {
  const std::vector<RowChunk> chunks = chunks_of(batch);
  const int classes = samples_->set().class_count();
  const std::size_t candidates = std::size_t(batch.size()) * padded_;
  stream_.send(scratch_.chunks, chunks);
  stream_.fit(scratch_.negated_low, candidates);
  stream_.fit(scratch_.high, candidates);
  stream_.clear(scratch_.class_counts, std::size_t(batch.size()) * classes);
  for (std::int32_t* values : {scratch_.negated_low.data(), scratch_.high.data()}) {
    stream_.launch(FillArguments{values, kLeast, static_cast<std::uint32_t>(candidates)}, candidates);
  }
  stream_.launch_blocks(
      RangesArguments{rows(), classes, scratch_.negated_low.data(), scratch_.high.data(), scratch_.class_counts.data()},
      chunks.size());
  const std::vector<std::int32_t> negated_low = stream_.fetch(scratch_.negated_low, candidates);
  const std::vector<std::int32_t> high = stream_.fetch(scratch_.high, candidates);
  const std::vector<std::int32_t> counts = stream_.fetch(scratch_.class_counts, std::size_t(batch.size()) * classes);
  std::vector<NodeValues> values;
  for (std::int32_t i = 0; i < batch.size(); ++i) {
    NodeValues& of_node = values.emplace_back();
    of_node.class_counts.assign(counts.begin() + std::ptrdiff_t(i) * classes,
                                counts.begin() + std::ptrdiff_t(i + 1) * classes);
    of_node.ranges = ValueRanges(padded_);
    const Node& node = level_[batch.begin + i];
    for (int c = 0; c < padded_ && node.row_end > node.row_begin; ++c) {
      const std::size_t at = std::size_t(i) * padded_ + c;
      of_node.ranges.low[c] = static_cast<std::int16_t>(-negated_low[at]);
      of_node.ranges.high[c] = static_cast<std::int16_t>(high[at]);
    }
  }
  return values;
}

std::vector<CountNode> DeviceTreeShard::count(NodeRange batch, const std::vector<CountTask>& tasks,
                                              const std::vector<int>& least) const {
  const std::size_t all_classes = samples_->set().class_count();
  std::vector<CountNode> nodes;
  std::vector<std::int16_t> low;
  std::vector<std::uint16_t> factor;
  std::vector<std::uint8_t> class_of;
  std::vector<std::int32_t> totals;
  std::uint64_t pairs = 0;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const CountTask& task = tasks[i];
    nodes.push_back({pairs, static_cast<std::uint32_t>(totals.size()), task.binning.bins,
                     static_cast<std::int32_t>(task.classes.size()), least.empty() ? 0 : least[i]});
    pairs += std::uint64_t(task.binning.bins) * task.classes.size() * (kBlockCandidates / 2);
    low.insert(low.end(), task.binning.low.begin(), task.binning.low.end());
    factor.insert(factor.end(), task.binning.factor.begin(), task.binning.factor.end());
    class_of.insert(class_of.end(), task.classes.index.begin(),
                    task.classes.index.begin() + std::ptrdiff_t(all_classes));
    totals.insert(totals.end(), task.classes.totals.begin(), task.classes.totals.end());
  }
  const std::vector<RowChunk> chunks = chunks_of(batch);
  stream_.send(scratch_.chunks, chunks);
  stream_.send(scratch_.count_nodes, nodes);
  stream_.send(scratch_.low, low);
  stream_.send(scratch_.factor, factor);
  stream_.send(scratch_.class_of, class_of);
  stream_.send(scratch_.totals, totals);
  stream_.clear(scratch_.counts, pairs);
  const CountArguments count{rows(),
                             {scratch_.count_nodes.data(), scratch_.counts.data(), padded_},
                             scratch_.low.data(),
                             scratch_.factor.data(),
                             scratch_.class_of.data(),
                             static_cast<std::int32_t>(all_classes)};
  stream_.launch_blocks(count, chunks.size(), static_cast<unsigned>(padded_ / 8));
  stream_->wait();
  return nodes;
}

std::vector<SplitHistogram> DeviceTreeShard::histograms(NodeRange batch, const std::vector<CountTask>& tasks) const {
  const std::vector<CountNode> nodes = count(batch, tasks, {});
  std::vector<SplitHistogram> histograms;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    SplitHistogram& histogram = histograms.emplace_back(tasks[i].classes.size(), tasks[i].binning.bins);
    if (histogram.counts.empty()) continue;
    stream_->copy_to_host(histogram.counts.data(), scratch_.counts.data() + nodes[i].first,
                          histogram.counts.size() * sizeof(std::uint16_t));
  }
  stream_->wait();
  return histograms;
}

std::vector<BinChoice> DeviceTreeShard::best_bins(NodeRange batch, const std::vector<CountTask>& tasks,
                                                  const std::vector<int>& least, int candidates,
                                                  const EntropyTable& entropy) const {
  const std::vector<CountNode> nodes = count(batch, tasks, least);
  if (scratch_.entropy.size() == 0) {
    const std::vector<std::int32_t> table(entropy.data(), entropy.data() + kMostCounted + 1);
    stream_.send(scratch_.entropy, table);
    stream_->wait();
  }
  const std::size_t totals = nodes.empty() ? 0 : nodes.back().totals + std::size_t(nodes.back().classes);
  stream_.fit(scratch_.best, nodes.size());
  stream_.fit(scratch_.below, totals);
  const BestArguments choose{{scratch_.count_nodes.data(), scratch_.counts.data(), padded_},
                             scratch_.totals.data(),
                             scratch_.entropy.data(),
                             candidates,
                             scratch_.best.data(),
                             scratch_.below.data()};
  stream_.launch_blocks(choose, nodes.size());
  const std::vector<BestOfNode> best = stream_.fetch(scratch_.best, nodes.size());
  const std::vector<std::int32_t> below = stream_.fetch(scratch_.below, totals);
  std::vector<BinChoice> choices;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto from = below.begin() + nodes[i].totals;
    choices.push_back({{best[i].candidate, best[i].bin, best[i].score}, {from, from + nodes[i].classes}});
  }
  return choices;
}

std::vector<IntervalValues> DeviceTreeShard::values_in(const std::vector<ValueInterval>& intervals) const {
  std::vector<std::int32_t> nodes;
  std::vector<Interval> asked;
  std::size_t rows_asked = 0;
  for (const ValueInterval& interval : intervals) {
    nodes.push_back(interval.node);
    asked.push_back({interval.candidate, interval.above, interval.last});
    rows_asked += level_[interval.node].row_end - level_[interval.node].row_begin;
  }
  const std::vector<RowChunk> chunks = chunks_of(nodes);
  stream_.send(scratch_.chunks, chunks);
  stream_.send(scratch_.intervals, asked);
  stream_.fit(scratch_.found, rows_asked);
  stream_.clear(scratch_.found_count, 1);
  stream_.launch_blocks(
      CollectArguments{rows(), scratch_.intervals.data(), scratch_.found.data(), scratch_.found_count.data()},
      chunks.size());
  const std::uint32_t count = stream_.fetch(scratch_.found_count, 1).front();
  std::vector<IntervalValues> values(intervals.size());
  for (const CollectedValue& one : stream_.fetch(scratch_.found, count)) {
    values[one.interval].values.push_back({one.value, one.label});
  }
  return values;
}

void DeviceTreeShard::set_splits(const std::vector<NodeSplit>& splits) {
  for (const NodeSplit& split : splits) {
    const TreeNode& node = split.split;
    splits_[split.node] = {node.du1, node.dv1, node.du2, node.dv2, node.threshold_mm, 1, 0, 0};
  }
}

ChildCounts DeviceTreeShard::route() {
  const int classes = samples_->set().class_count();
  const Samples samples = samples_->describe();
  const std::size_t cells = 2 * level_.size() * std::size_t(classes);
  stream_.send(scratch_.splits, splits_);
  stream_.clear(scratch_.children, cells);
  stream_.launch(RouteArguments{samples_->frames(), samples, scratch_.splits.data(), node_of_.data(), classes,
                                scratch_.children.data()},
                 samples.count);
  const std::vector<std::uint32_t> counts = stream_.fetch(scratch_.children, cells);
  ChildCounts children{classes, {counts.begin(), counts.end()}};
  child_sizes_ = vesalius::child_sizes(children);
  move_samples(children);
  return children;
}

/// Brings the samples of each child together. Those of nodes that are done are left out.
void DeviceTreeShard::move_samples(const ChildCounts& children) {
  std::vector<MoveNode> moves;
  std::uint32_t level_begin = 0, right_before = 0;
  child_begin_.assign(children.children(), 0);
  for (std::size_t n = 0; n < level_.size(); ++n) {
    const auto left = static_cast<std::uint32_t>(child_sizes_[2 * n]);
    const auto right = static_cast<std::uint32_t>(child_sizes_[2 * n + 1]);
    child_begin_[2 * n] = level_begin;
    child_begin_[2 * n + 1] = level_begin + left;
    // Nodes without samples are left out: the search for a node looks for the last that begins before a sample.
    if (left + right > 0) {
      moves.push_back({level_[n].begin, level_begin, level_begin, level_begin + left, right_before});
    }
    level_begin += left + right;
    right_before += right;
  }
  const std::size_t in_block = std::size_t{TrainStream::kThreads} * kMoveRun;
  const std::size_t blocks = (level_begin + in_block - 1) / in_block;
  stream_.send(scratch_.moves, moves);
  stream_.fit(scratch_.of_block, blocks);
  stream_.fit(scratch_.next_order, order_.size());
  const Moves all{scratch_.moves.data(), static_cast<std::int32_t>(moves.size()), level_begin, order_.data(),
                  node_of_.data()};
  stream_.launch_blocks(CountRightArguments{all, scratch_.of_block.data()}, blocks);
  const std::vector<std::uint32_t> right = stream_.fetch(scratch_.of_block, blocks);
  std::vector<std::uint32_t> before(blocks, 0);
  std::exclusive_scan(right.begin(), right.end(), before.begin(), 0U);
  stream_.send(scratch_.of_block, before);
  stream_.launch_blocks(MoveArguments{all, scratch_.of_block.data(), scratch_.next_order.data()}, blocks);
  stream_->wait();
  std::swap(order_, scratch_.next_order);
}

DeviceTree::DeviceTree(const std::vector<std::shared_ptr<const DeviceSamples>>& samples, const GrowTreeOptions& options,
                       int tree) {
  for (const auto& of_shard : samples) shards_.emplace_back(of_shard, options, tree);
}

std::vector<BinChoice> DeviceTree::best_bins(NodeRange batch, const std::vector<CountTask>& tasks,
                                             const std::vector<int>& least, int candidates,
                                             const EntropyTable& entropy) {
  if (shards_.size() > 1) return TreeExecutor::best_bins(batch, tasks, least, candidates, entropy);
  return shards_.front().best_bins(batch, tasks, least, candidates, entropy);
}

}  // namespace vesalius::gpu
