#include "cuda_train/device_leaves.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "cuda/device_labeller.h"
#include "cuda/kernels.h"
#include "train/leaves/leaf_shard.h"
#include "vesalius/error.h"

namespace vesalius::gpu {

DeviceLeafShard::DeviceLeafShard(std::shared_ptr<const DeviceSamples> samples, const Forest& forest, LogitLayout layout)
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

LabelCounts DeviceLeafShard::label_counts() const { return count_labels(samples_->here(), layout_); }

void DeviceLeafShard::set_weights(const SampleWeights& weights) {
  weighted_headings_ = static_cast<std::int32_t>(weights.of_heading.size());
  stream_.send(of_class_, weights.of_class);
  stream_.send(of_heading_, weights.of_heading);
  stream_->wait();
}

LeafLabels DeviceLeafShard::labels() const {
  return {of_class_.data(),  of_heading_.data(), groups_.data(), layout_.parts,
          layout_.classes(), layout_.headings,   layout_.size(), weighted_headings_};
}

LeafCounts DeviceLeafShard::leaf_counts(int tree) const {
  const Samples samples = samples_->describe();
  const std::size_t cells = std::size_t(first_leaf_[tree + 1] - first_leaf_[tree]) * layout_.size();
  stream_.clear(weights_, cells);
  stream_.launch(
      LeafWeightsArguments{samples, labels(), leaves_.data() + std::size_t(tree) * samples.count, weights_.data()},
      samples.count);
  const std::vector<std::uint64_t> sums = stream_.fetch(weights_, cells);
  return {{sums.begin(), sums.end()}};
}

LeafGradient DeviceLeafShard::gradient(const LeafLogits& logits, const GradientTask& task) const {
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

DeviceLeaves::DeviceLeaves(const std::vector<std::shared_ptr<const DeviceSamples>>& samples, const Forest& forest,
                           const LogitLayout& layout) {
  for (const auto& of_shard : samples) shards_.emplace_back(of_shard, forest, layout);
}

}  // namespace vesalius::gpu
