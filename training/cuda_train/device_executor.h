#pragma once

#include <memory>
#include <vector>

#include "cuda_train/device_samples.h"
#include "train/local_executor.h"

namespace vesalius::gpu {

/// All shards of a training, on one or more devices: the same bytes as LocalExecutor. Where there are more devices than
/// sets, each set's frames are divided among some of them; else the sets go to the devices in turn. Growing trees and
/// learning leaves is the devices' work; hard negatives and the headings' regression, which only look at few samples,
/// the processor's.
class DeviceExecutor : public Executor {
 public:
  /// As LocalExecutor; there is at least one device. Throws DeviceError if a device has no room for its frames.
  DeviceExecutor(const std::vector<TrainingSet*>& sets, const std::vector<std::shared_ptr<Device>>& devices,
                 int trees_at_once = 1);

  void grow_trees(const Forest& forest, const GrowTreeOptions& options, const std::vector<int>& numbers,
                  GrowProgress& progress, const TakeTree& take) override;
  HardCounts count_hard_negatives(const Forest& forest) override { return local_.count_hard_negatives(forest); }
  std::size_t add_hard_negatives(const HardCut& cut) override { return local_.add_hard_negatives(cut); }
  std::unique_ptr<LeafExecutor> begin_leaves(const Forest& forest, const LogitLayout& layout) override;
  std::vector<FacingSample> facing_samples(const Forest& forest) override { return local_.facing_samples(forest); }

 private:
  std::vector<std::shared_ptr<const DeviceSamples>> samples() const;

  LocalExecutor local_;
  /// Frames of a set on one device.
  struct Shard {
    const TrainingSet* set = nullptr;
    std::shared_ptr<const DeviceFrames> frames;
    bool leads = true;  ///< whether it is the first of the set
  };
  std::vector<Shard> shards_;
  int trees_at_once_;
};

}  // namespace vesalius::gpu
