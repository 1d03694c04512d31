#include "cuda_train/device_executor.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cuda/device_labeller.h"
#include "cuda/kernels.h"
#include "cuda_train/device_samples.h"
#include "cuda_train/device_tree.h"
#include "train/grow_tree.h"
#include "train/leaves/leaf_shard.h"
#include "train/local_shards.h"
#include "train/messages/training_messages.h"
#include "vesalius/error.h"
#include "vesalius/forest.h"

namespace vesalius::gpu {
namespace {

/// One shard's part in learning the leaves of a forest, as LeafShard, on a device. Requests come one at a time.
class DeviceLeafShard {
 public:
  /// Throws DeviceError for leaves with more than 2048 logits.
  DeviceLeafShard(std::shared_ptr<const DeviceSamples> samples, const Forest& forest, LogitLayout layout)
      : samples_(std::move(samples)), layout_(std::move(layout)), stream_(samples_->device()) {
    if (layout_.size() > int(kSharedLogits)) {
      throw DeviceError(stream_.device()->name() + ": leaves with " + std::to_string(layout_.size()) +
                        " logits, expected at most 2048");
    }
    const Samples described = samples_->describe();
    stream_.fit(leaves_, forest.trees.size() * described.count);
    std::uint32_t leaf = 0;
    for (std::size_t t = 0; t < forest.trees.size(); ++t) {
      const Tree& tree = forest.trees[t];
      first_leaf_.push_back(leaf);
      leaf += static_cast<std::uint32_t>(tree.leaves.size());
      std::vector<PlainNode> nodes;
      for (const TreeNode& n : tree.nodes) {
        nodes.push_back({n.du1, n.dv1, n.du2, n.dv2, n.threshold_mm, 1, n.left, n.right});
      }
      DeviceArray<PlainNode> on_device;
      stream_.send(on_device, nodes);
      stream_.launch(FindLeavesArguments{samples_->frames(), described, on_device.data(),
                                         static_cast<std::int32_t>(nodes.size()), leaves_.data() + t * described.count},
                     described.count);
      stream_->wait();
    }
    first_leaf_.push_back(leaf);
    const std::vector<std::uint8_t> groups = groups_of(layout_);
    stream_.send(groups_, groups);
    stream_.send(device_first_leaf_, first_leaf_);
    stream_->wait();
  }

  LabelCounts label_counts() const { return count_labels(samples_->here(), layout_); }

  void set_weights(const SampleWeights& weights) {
    weighted_headings_ = static_cast<std::int32_t>(weights.of_heading.size());
    stream_.send(of_class_, weights.of_class);
    stream_.send(of_heading_, weights.of_heading);
    stream_->wait();
  }

  LeafCounts leaf_counts(int tree) const {
    const Samples samples = samples_->describe();
    const std::size_t cells = std::size_t(first_leaf_[tree + 1] - first_leaf_[tree]) * layout_.size();
    stream_.clear(weights_, cells);
    stream_.launch(
        LeafWeightsArguments{samples, labels(), leaves_.data() + std::size_t(tree) * samples.count, weights_.data()},
        samples.count);
    const std::vector<std::uint64_t> sums = stream_.fetch(weights_, cells);
    return {{sums.begin(), sums.end()}};
  }

  LeafGradient gradient(const LeafLogits& logits, const GradientTask& task) const {
    const std::size_t trees = logits.of_trees.size(), all = std::size_t{first_leaf_.back()} * logits.stride;
    stream_.fit(logits_, all);
    for (std::size_t t = 0; t < trees; ++t) {
      const std::vector<std::int16_t>& of_tree = logits.of_trees[t];
      stream_->copy_to_device(logits_.data() + std::size_t{first_leaf_[t]} * logits.stride, of_tree.data(),
                              of_tree.size() * sizeof(std::int16_t));
    }
    stream_.clear(gradients_, all);
    stream_.clear(likelihood_, 2);
    GradientArguments a{samples_->describe(), labels(), leaves_.data(), device_first_leaf_.data(), logits_.data()};
    a.gradients = gradients_.data();
    a.trees = static_cast<std::int32_t>(trees);
    a.stride = static_cast<std::int32_t>(logits.stride);
    a.unit = LeafLogits::kUnit;
    a.scale = std::ldexp(1.F, task.shift) / float(SampleWeights::kOne);
    a.portion = static_cast<std::uint32_t>(task.portion);
    a.portions = static_cast<std::uint32_t>(task.portions);
    a.first_frame = static_cast<std::uint32_t>(samples_->set().first_frame());
    const unsigned in_block =
        pixels_in_block(TrainStream::kThreads, kLogitLanes, static_cast<unsigned>(layout_.size()), kSharedLogits);
    a.samples_in_block = static_cast<std::int32_t>(in_block);
    a.likelihood = likelihood_.data();
    a.weight = likelihood_.data() + 1;
    stream_.launch_blocks(a, (a.samples.count + in_block - 1) / in_block);
    LeafGradient gradient;
    for (std::size_t t = 0; t < trees; ++t) {
      std::vector<std::int32_t>& of_tree = gradient.of_trees.emplace_back(logits.of_trees[t].size());
      stream_->copy_to_host(of_tree.data(), gradients_.data() + std::size_t{first_leaf_[t]} * logits.stride,
                            of_tree.size() * sizeof(std::int32_t));
    }
    const std::vector<std::uint64_t> sums = stream_.fetch(likelihood_, 2);
    gradient.log_likelihood = double(static_cast<std::int64_t>(sums[0])) / 4096.0 / SampleWeights::kOne;
    gradient.weight = double(sums[1]) / SampleWeights::kOne;
    return gradient;
  }

 private:
  LeafLabels labels() const {
    return {of_class_.data(),  of_heading_.data(), groups_.data(), layout_.parts,
            layout_.classes(), layout_.headings,   layout_.size(), weighted_headings_};
  }

  std::shared_ptr<const DeviceSamples> samples_;
  LogitLayout layout_;
  std::vector<std::uint32_t> first_leaf_;  ///< [tree]; behind the last the number of all
  DeviceArray<std::uint32_t> leaves_, device_first_leaf_;
  DeviceArray<std::uint8_t> groups_;
  DeviceArray<std::int32_t> of_class_, of_heading_;
  std::int32_t weighted_headings_ = 0;
  mutable DeviceArray<std::uint64_t> weights_, likelihood_;
  mutable DeviceArray<std::int16_t> logits_;
  mutable DeviceArray<std::int32_t> gradients_;
  TrainStream stream_;
};

/// The shards of learning leaves, each on a device.
class DeviceLeaves : public ShardedLeaves<DeviceLeafShard> {
 public:
  DeviceLeaves(const std::vector<std::shared_ptr<const DeviceSamples>>& samples, const Forest& forest,
               const LogitLayout& layout) {
    for (const auto& of_shard : samples) shards_.emplace_back(of_shard, forest, layout);
  }
};

/// Returns where `parts` parts of a set's frames end that have about as many samples.
std::vector<std::uint32_t> ends_of_parts(const TrainingSet& set, std::size_t parts) {
  const std::span<const TrainingSample> samples = set.samples();
  std::vector<std::uint32_t> ends;
  for (std::size_t p = 1; p < parts; ++p) {
    ends.push_back(samples.empty() ? 0 : samples[samples.size() * p / parts].frame);
  }
  ends.push_back(static_cast<std::uint32_t>(set.frames().size()));
  return ends;
}

}  // namespace

DeviceExecutor::DeviceExecutor(const std::vector<TrainingSet*>& sets,
                               const std::vector<std::shared_ptr<Device>>& devices, int trees_at_once)
    : local_(sets, trees_at_once), trees_at_once_(trees_at_once) {
  const std::size_t parts = std::max<std::size_t>(1, devices.size() / sets.size());
  for (const TrainingSet* set : sets) {
    std::uint32_t first = 0;
    for (const std::uint32_t end : ends_of_parts(*set, parts)) {
      const std::shared_ptr<Device>& device = devices[shards_.size() % devices.size()];
      const bool leads = shards_.empty() || shards_.back().set != set;
      shards_.push_back({set, std::make_shared<const DeviceFrames>(set->frames(), first, end, device), leads});
      first = end;
    }
  }
}

std::vector<std::shared_ptr<const DeviceSamples>> DeviceExecutor::samples() const {
  std::vector<std::shared_ptr<const DeviceSamples>> all;
  for (const Shard& shard : shards_) {
    all.push_back(std::make_shared<const DeviceSamples>(*shard.set, shard.frames, shard.leads));
  }
  return all;
}

void DeviceExecutor::grow_trees(const Forest& forest, const GrowTreeOptions& options, const std::vector<int>& numbers,
                                GrowProgress& progress, const TakeTree& take) {
  GrowTreeOptions in_one_batch = options;  // small batches are for a processor's cache
  in_one_batch.batch_bytes = std::numeric_limits<std::size_t>::max() / 4;
  const std::vector<std::shared_ptr<const DeviceSamples>> all = samples();
  for_trees(numbers, trees_at_once_, [&](int number) {
    DeviceTree shards(all, in_one_batch, number);
    take(number, grow_tree(shards, forest, in_one_batch, number, progress));
  });
}

std::unique_ptr<LeafExecutor> DeviceExecutor::begin_leaves(const Forest& forest, const LogitLayout& layout) {
  return std::make_unique<DeviceLeaves>(samples(), forest, layout);
}

}  // namespace vesalius::gpu
