#include "cuda_train/device_executor.h"

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include "cuda_train/device_leaves.h"
#include "cuda_train/device_tree.h"
#include "train/grow_tree.h"

namespace vesalius::gpu {

namespace {

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
