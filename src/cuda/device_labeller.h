#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "cuda/device.h"
#include "cuda/kernels.h"
#include "vesalius/base/pool.h"
#include "vesalius/camera.h"
#include "vesalius/forest.h"
#include "vesalius/forest/label_pixels.h"
#include "vesalius/forest/smooth_labels.h"
#include "vesalius/image.h"
#include "vesalius/labeller.h"

namespace vesalius::gpu {

struct DeviceLabellerOptions {
  unsigned threads = 256;  ///< threads of a block, kLeastThreads to kMostThreads
  /// Most pixels that one stream works on at a time; a picture with more is worked on alone.
  std::uint32_t batch_pixels = 1U << 21U;
};

/// Returns the group of each place of a leaf's logits (kernels.cuh, LogitGroups).
std::vector<std::uint8_t> groups_of(const LogitLayout& layout);

/// A forest in a device's memory.
class DeviceForest {
 public:
  /// Throws Error for a tree that cannot be packed and DeviceError if the device cannot take it.
  DeviceForest(const Forest& forest, const std::shared_ptr<Device>& device);

  const FeatureConvention& convention() const { return convention_; }
  int trees() const { return int(places_.size()); }
  bool has_logits() const { return logit_unit_ > 0.F; }

  /// These tell a kernel where the forest is.
  void describe(WalkArguments& walk) const;
  void describe(AddArguments& add) const;
  void describe(LogitArguments& read) const;

 private:
  FeatureConvention convention_;
  float logit_unit_ = 0.F;
  std::uint32_t leaf_bytes_ = 0;
  int headings_ = 0;
  DeviceArray<TreePlace> places_;
  DeviceArray<std::uint32_t> words_;
  DeviceArray<TreeLeaf> leaves_;
  DeviceArray<std::int8_t> logits_;
  DeviceArray<std::uint8_t> groups_;
};

/// Labels on a card: bit for bit what ForestLabeller gives, whatever the gate is. Calls from several threads run beside
/// each other, each in a stream and in memory of its own, which is kept for the next.
class DeviceLabeller : public TrainedLabeller {
 public:
  /// Throws Error for an inconsistent forest or options and DeviceError if the device fails.
  DeviceLabeller(const Forest& forest, std::shared_ptr<Device> device, DeviceLabellerOptions options = {});
  ~DeviceLabeller() override;

  /// Throws Error for a picture of more than 16,000 pixels a side and DeviceError if the device fails; `out` is then
  /// undefined.
  void label_into(const Frame& frame, float gate, Posteriors& out) const override;
  bool label_and_smooth_into(const Frame& frame, float gate, const SmoothOptions& options, Posteriors& out,
                             Posteriors& smooth) const override;

  /// Returns the labels of pictures, which may differ in size, as choose_labels chooses them from the mean_filter of
  /// their posteriors. Only depth goes to the device and only labels come back. Pictures of one size are worked on in
  /// batches, and while one batch is worked on, the one before comes back and the next goes there. `cameras` has one
  /// for each picture. Throws Error for another number of cameras.
  std::vector<LabelImage> label_pictures(const std::vector<DepthImage>& pictures, const std::vector<Camera>& cameras,
                                         const LabelOptions& label, const SmoothOptions& smooth) const;

 private:
  class Workspace;
  struct Batch;

  std::unique_ptr<Workspace> take() const;
  std::unique_ptr<Workspace> start(const Frame& frame, float gate, Posteriors& out) const;

  DeviceLabellerOptions options_;
  std::shared_ptr<Device> device_;
  DeviceForest forest_;
  mutable Pool<std::unique_ptr<Workspace>> free_;
};

}  // namespace vesalius::gpu
