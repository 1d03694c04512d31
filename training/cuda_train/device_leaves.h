#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "cuda_train/device_samples.h"
#include "train/local_shards.h"
#include "train/messages/training_messages.h"
#include "vesalius/forest.h"

namespace vesalius::gpu {

/// One shard's part in learning the leaves of a forest, as LeafShard, on a device. Requests come one at a time.
class DeviceLeafShard {
 public:
  /// Throws DeviceError for leaves with more than 2048 logits.
  DeviceLeafShard(std::shared_ptr<const DeviceSamples> samples, const Forest& forest, LogitLayout layout);

  LabelCounts label_counts() const;
  void set_weights(const SampleWeights& weights);
  LeafCounts leaf_counts(int tree) const;
  LeafGradient gradient(const LeafLogits& logits, const GradientTask& task) const;

 private:
  LeafLabels labels() const;

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
               const LogitLayout& layout);
};

}  // namespace vesalius::gpu
