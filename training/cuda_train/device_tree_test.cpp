#include "cuda_train/device_tree.h"

#include <gmock/gmock.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "cuda_train/test_simulated_training.h"
#include "train/growing_tree.h"
#include "train/split_candidates.h"
#include "train/split_histogram.h"
#include "train/test_training.h"
#include "train/tree_shard.h"

namespace vesalius::gpu {
namespace {

/// Asks a shard on the processor and one on a device the same, level by level, and compares their replies.
class BothShards {
 public:
  BothShards(const TrainingSet& set, const GrowTreeOptions& options, const SimulatedDeviceOptions& simulated = {})
      : options_(options),
        convention_(set.convention()),
        processor_(set, options, 0),
        grown_(set.sample_counts(), set.body().part_count(), options) {
    const auto device = test::simulated_training(simulated);
    const auto count = static_cast<std::uint32_t>(set.frames().size());
    const auto frames = std::make_shared<const DeviceFrames>(set.frames(), 0, count, device);
    device_.emplace(std::make_shared<const DeviceSamples>(set, frames), options, 0);
  }

  /// Returns the first reply that differs; empty if all are the same.
  std::string grow() {
    const TreeRoot root{1, processor_.sample_counts().samples};
    std::vector<std::int32_t> node_of_child = grown_.begin({&root, 1});
    while (!grown_.level().empty()) {
      Level level{std::move(node_of_child), {}};
      for (const OpenNode& open : grown_.level()) level.nodes.push_back(open.node);
      const ChildSizes before(level.node_of_child.size(), 0);
      processor_.open_level(level, before);
      device_->open_level(level, before);
      if (const std::string different = split(level); !different.empty()) return different;
      const ChildCounts expected = processor_.route(), found = device_->route();
      for (std::size_t n = 0; n < level.nodes.size(); ++n) {
        if (grown_.level()[n].gain == 0) continue;
        if (!std::equal(expected.of(2 * n), expected.of(2 * n) + 2 * expected.classes, found.of(2 * n))) {
          return "samples at the children";
        }
      }
      node_of_child = grown_.descend(expected);
      ++levels;
    }
    return {};
  }

  int levels = 0;

 private:
  std::string split(const Level& level) {
    const NodeRange all{0, static_cast<std::int32_t>(level.nodes.size())};
    processor_.evaluate(all, 0);
    device_->evaluate(all, 0);
    const std::vector<NodeValues> expected = processor_.node_values(all), found = device_->node_values(all);
    std::vector<CountTask> tasks;
    std::vector<int> least;
    for (std::size_t n = 0; n < expected.size(); ++n) {
      if (found[n].class_counts != expected[n].class_counts) return "class counts";
      if (found[n].ranges.low != expected[n].ranges.low || found[n].ranges.high != expected[n].ranges.high) {
        return "ranges";
      }
      tasks.push_back({{expected[n].ranges, bins_for(level.nodes[n].counted, options_.split.bins)},
                       ClassIndex(expected[n].class_counts)});
      least.push_back(least_samples(level.nodes[n], options_.leaf));
    }
    const std::vector<SplitHistogram> counts = processor_.histograms(all, tasks);
    const std::vector<SplitHistogram> device_counts = device_->histograms(all, tasks);
    for (std::size_t n = 0; n < counts.size(); ++n) {
      if (device_counts[n].counts != counts[n].counts) return "histograms";
    }
    const int candidates = std::min(options_.split.candidates, kBlockCandidates);
    const std::vector<BinChoice> best = device_->best_bins(all, tasks, least, candidates, entropy_);
    std::vector<ValueInterval> intervals;
    std::vector<NodeSplit> splits;
    for (std::size_t n = 0; n < counts.size(); ++n) {
      const BinChoice choice = choose_bin(counts[n], candidates, tasks[n].classes, least[n], entropy_);
      if (best[n].split.candidate != choice.split.candidate) return "best candidates";
      if (choice.split.candidate < 0) continue;
      if (best[n].split.bin != choice.split.bin || best[n].split.score != choice.split.score) return "best bins";
      if (best[n].below != choice.below) return "samples below the best bins";
      intervals.push_back(beside(choice.split, tasks[n].binning, static_cast<std::int32_t>(n)));
      const CandidateTable table = node_candidates(convention_, options_, 0, level.nodes[n].number, 0);
      splits.push_back({static_cast<std::int32_t>(n), choice.split.candidate, table.node(choice.split.candidate)});
    }
    const std::vector<IntervalValues> values = processor_.values_in(intervals);
    if (sorted(values) != sorted(device_->values_in(intervals))) return "values in intervals";
    for (std::size_t i = 0; i < splits.size(); ++i) {
      const std::int32_t n = splits[i].node;
      const ThresholdSplit refined = refine_split(values[i], best[n], tasks[n].classes, least[n], entropy_);
      splits[i].split.threshold_mm = static_cast<std::int16_t>(refined.threshold_mm);
      grown_.offer(n, splits[i].split, 1.0);
    }
    processor_.set_splits(splits);
    device_->set_splits(splits);
    return {};
  }

  static std::vector<std::vector<std::pair<int, int>>> sorted(const std::vector<IntervalValues>& values) {
    std::vector<std::vector<std::pair<int, int>>> all;
    for (const IntervalValues& interval : values) {
      auto& pairs = all.emplace_back();
      for (const LabelledValue& one : interval.values) pairs.emplace_back(one.value, one.label);
      std::ranges::sort(pairs);
    }
    return all;
  }

  GrowTreeOptions options_;
  FeatureConvention convention_;
  TreeShard processor_;
  std::optional<DeviceTreeShard> device_;
  GrowingTree grown_;
  EntropyTable entropy_;
};

class DeviceTreeShardTest : public testing::Test {
 protected:
  DeviceTreeShardTest() {
    options_.sample.pixels_per_frame = 200;
    options_.sample.held_out_share = 0.F;
    options_.grow.leaf.max_depth = 8;
    options_.grow.leaf.min_samples = 4;
    options_.grow.split.candidates = 128;  // two blocks: then the processor looks anew to route, as the device does
    options_.grow.split.split_pixels = 300;
    sets_ = test::shards_of({12}, test::noisy_frames(12, 3.1), options_);
  }

  TrainOptions options_;
  std::vector<TrainingSet> sets_;
};

TEST_F(DeviceTreeShardTest, AnswersAsAShardOnTheProcessor) {
  BothShards both(sets_.front(), options_.grow);
  EXPECT_EQ(both.grow(), "");
  EXPECT_GT(both.levels, 5);
}

TEST_F(DeviceTreeShardTest, NeedsEveryBarrier) {
  for (const char* kernel : {RangesArguments::kName, CountArguments::kName, BestArguments::kName}) {
    for (const int barrier : {0, 1}) {
      bool found = false;
      for (const bool backwards : {false, true}) {
        const SimulatorOptions simulator{
            .backwards = backwards, .zeroed = true, .faults = {.left_out_barrier = barrier}};
        BothShards both(sets_.front(), options_.grow, {.simulator = simulator, .faulty_kernel = kernel});
        found = found || !both.grow().empty();
      }
      EXPECT_TRUE(found) << kernel << ", barrier " << barrier;
    }
  }
}

/// Rows of one node of a body with many parts.
struct ManyClasses {
  static constexpr int kClasses = 70, kWidth = 16;
  std::vector<std::int16_t> values;
  std::vector<std::uint8_t> labels;

  ManyClasses() {
    Random random(6);
    for (int r = 0; r < 3000; ++r) {
      labels.push_back(static_cast<std::uint8_t>(random.below(kClasses)));
      for (int c = 0; c < kWidth; ++c) values.push_back(static_cast<std::int16_t>(random.below(4000) - 2000));
    }
  }
  FeatureRows rows() const { return {values.data(), labels.data(), labels.size(), kWidth}; }

  /// Counts them on a device, in two chunks.
  std::vector<std::uint16_t> counts(const CountTask& task, const SimulatedDeviceOptions& options) const {
    const TrainStream stream(test::simulated_training(options));
    DeviceArray<std::int16_t> device_values, low;
    DeviceArray<std::uint8_t> device_labels, class_of;
    DeviceArray<std::uint16_t> factor;
    DeviceArray<RowChunk> chunks;
    DeviceArray<CountNode> nodes;
    DeviceArray<std::uint32_t> counts;
    const std::vector<RowChunk> all{{0, 0, 2000}, {0, 2000, 1000}};
    const std::vector<CountNode> node{{0, 0, task.binning.bins, static_cast<std::int32_t>(task.classes.size()), 1}};
    const std::size_t pairs = task.classes.size() * task.binning.bins * kBlockCandidates / 2;
    stream.send(device_values, values);
    stream.send(device_labels, labels);
    stream.send(low, task.binning.low);
    stream.send(factor, task.binning.factor);
    stream.send(class_of, task.classes.index);
    stream.send(chunks, all);
    stream.send(nodes, node);
    stream.clear(counts, pairs);
    stream.launch_blocks(CountArguments{{chunks.data(), device_values.data(), device_labels.data(), kWidth},
                                        {nodes.data(), counts.data(), kWidth},
                                        low.data(),
                                        factor.data(),
                                        class_of.data(),
                                        kClasses},
                         all.size(), kWidth / 8);
    std::vector<std::uint16_t> found;
    for (const std::uint32_t pair : stream.fetch(counts, pairs)) {
      found.push_back(static_cast<std::uint16_t>(pair));
      found.push_back(static_cast<std::uint16_t>(pair >> 16U));
    }
    return found;
  }
};

TEST(CountRows, CountsMoreClassesThanABlockHasRoomForAndNeedsEveryBarrier) {
  const ManyClasses many;
  const NodeValues node = node_values(many.rows(), ManyClasses::kClasses);
  const CountTask task{{node.ranges, 32}, ClassIndex(node.class_counts)};
  ASSERT_GT(task.classes.size() * 32 * 4, 2 * std::size_t{kSharedCounts}) << "three passes";
  const std::vector<std::uint16_t> expected = count_bins(many.rows(), task).counts;
  for (const bool backwards : {false, true}) {
    EXPECT_EQ(many.counts(task, {.simulator = {.backwards = backwards}}), expected);
  }
  for (const int barrier : {0, 1, 3, 4, 6, 7}) {  // a pass has two, and three phases
    bool found = false;
    for (const bool backwards : {false, true}) {
      const SimulatorOptions simulator{.backwards = backwards, .zeroed = true, .faults = {.left_out_barrier = barrier}};
      found = found || many.counts(task, {.simulator = simulator}) != expected;
    }
    EXPECT_TRUE(found) << "barrier " << barrier;
  }
}

/// Moves the samples of one node by the parity of their child, on a device with these options.
std::vector<std::uint32_t> moved(const std::vector<std::int32_t>& node_of, const SimulatorOptions& simulator,
                                 const std::string& faulty_kernel = {}) {
  const TrainStream stream(test::simulated_training({.simulator = simulator, .faulty_kernel = faulty_kernel}));
  const auto count = static_cast<std::uint32_t>(node_of.size());
  const auto left = static_cast<std::uint32_t>(std::ranges::count_if(node_of, [](int n) { return n % 2 == 0; }));
  const std::vector<MoveNode> nodes{{0, 0, 0, left, 0}};
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  DeviceArray<MoveNode> device_nodes;
  DeviceArray<std::uint32_t> device_order, of_block, next;
  DeviceArray<std::int32_t> device_node_of;
  stream.send(device_nodes, nodes);
  stream.send(device_order, order);
  stream.send(device_node_of, node_of);
  stream.clear(next, count);
  const std::size_t blocks = (count + TrainStream::kThreads * kMoveRun - 1) / (TrainStream::kThreads * kMoveRun);
  stream.fit(of_block, blocks);
  const Moves moves{device_nodes.data(), 1, count, device_order.data(), device_node_of.data()};
  stream.launch_blocks(CountRightArguments{moves, of_block.data()}, blocks);
  const std::vector<std::uint32_t> right = stream.fetch(of_block, blocks);
  std::vector<std::uint32_t> before(blocks, 0);
  std::exclusive_scan(right.begin(), right.end(), before.begin(), 0U);
  stream.send(of_block, before);
  stream.launch_blocks(MoveArguments{moves, of_block.data(), next.data()}, blocks);
  return stream.fetch(next, count);
}

class MoveSamples : public testing::Test {
 protected:
  MoveSamples() {
    Random random(3);
    for (std::int32_t& n : node_of_) n = static_cast<std::int32_t>(random.below(2));
    std::iota(expected_.begin(), expected_.end(), 0U);
    std::stable_partition(expected_.begin(), expected_.end(), [&](std::uint32_t s) { return node_of_[s] == 0; });
  }

  /// Returns whether a barrier that is left out shows in either order of threads.
  bool shows(const std::string& kernel, int barrier) const {
    const Faults fault{.left_out_barrier = barrier};
    try {
      return moved(node_of_, {.zeroed = true, .faults = fault}, kernel) != expected_ ||
             moved(node_of_, {.backwards = true, .zeroed = true, .faults = fault}, kernel) != expected_;
    } catch (const std::logic_error&) {  // the simulator noticed it
      return true;
    }
  }

  std::vector<std::int32_t> node_of_ = std::vector<std::int32_t>(9001);
  std::vector<std::uint32_t> expected_ = std::vector<std::uint32_t>(9001);
};

TEST_F(MoveSamples, KeepsTheirOrderInBothChildren) {
  for (const bool backwards : {false, true}) EXPECT_EQ(moved(node_of_, {.backwards = backwards}), expected_);
}

TEST_F(MoveSamples, NeedsEveryBarrier) {
  // Samples may be moved anywhere, so each try has a process of its own: one that dies has shown the fault too.
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto ends_badly = [](int status) { return !WIFEXITED(status) || WEXITSTATUS(status) != 0; };
  for (const auto& [kernel, barriers] :
       {std::pair{CountRightArguments::kName, 2}, std::pair{MoveArguments::kName, 9}}) {
    for (int barrier = 0; barrier < barriers; ++barrier) {
      EXPECT_EXIT(std::_Exit(shows(kernel, barrier) ? 1 : 0), ends_badly, "") << kernel << ", barrier " << barrier;
    }
  }
}

}  // namespace
}  // namespace vesalius::gpu
