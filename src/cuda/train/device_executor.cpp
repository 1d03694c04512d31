#include "cuda/train/device_executor.h"

#include <limits>
#include <utility>

#include "cuda/train/device_leaves.h"
#include "cuda/train/device_tree.h"
#include "train/grow_tree.h"

namespace vesalius::gpu {

DeviceExecutor::DeviceExecutor(std::vector<TrainingSet*> sets, const std::vector<std::shared_ptr<Device>>& devices,
                               int trees_at_once)
    : local_(sets, trees_at_once), sets_(sets.begin(), sets.end()), trees_at_once_(trees_at_once) {
  for (std::size_t i = 0; i < sets_.size(); ++i) {
    frames_.push_back(std::make_shared<const DeviceFrames>(sets_[i]->frames(), devices[i % devices.size()]));
  }
}

std::vector<std::shared_ptr<const DeviceSamples>> DeviceExecutor::samples() const {
  std::vector<std::shared_ptr<const DeviceSamples>> all;
  for (std::size_t i = 0; i < sets_.size(); ++i) {
    all.push_back(std::make_shared<const DeviceSamples>(*sets_[i], frames_[i]));
  }
  return all;
}

void DeviceExecutor::grow_trees(const Forest& forest, const GrowTreeOptions& options, const std::vector<int>& numbers,
                                GrowProgress& progress, const TakeTree& take) {
  GrowTreeOptions in_one_batch = options;  // small batches are for a processor's cache
  in_one_batch.batch_bytes = std::numeric_limits<std::size_t>::max() / 4;
  const std::vector<std::shared_ptr<const DeviceSamples>> all = samples();
  for_trees(numbers, trees_at_once_, [&](int number) {
    DeviceTree shards(sets_, all, in_one_batch, number);
    take(number, grow_tree(shards, forest, in_one_batch, number, progress));
  });
}

std::unique_ptr<LeafExecutor> DeviceExecutor::begin_leaves(const Forest& forest, const LogitLayout& layout) {
  return std::make_unique<DeviceLeaves>(sets_, samples(), forest, layout);
}

}  // namespace vesalius::gpu
