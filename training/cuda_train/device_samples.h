#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "cuda/device.h"
#include "cuda_train/train_kernels.h"
#include "train/samples/training_set.h"

namespace vesalius::gpu {

/// Frames in a device's memory: packed tiles, which never change while a forest is trained.
class DeviceFrames {
 public:
  /// Takes frames `first` to `end` - 1. Throws DeviceError if the device has no room for them.
  DeviceFrames(const FrameStore& frames, std::uint32_t first, std::uint32_t end, std::shared_ptr<Device> device);

  const std::shared_ptr<Device>& device() const { return device_; }
  TiledFrames describe() const;
  std::uint32_t first() const { return first_; }
  std::uint32_t end() const { return end_; }

 private:
  std::shared_ptr<Device> device_;
  FeatureConvention convention_;
  std::uint32_t first_, end_;
  DeviceArray<std::uint32_t> words_;
  DeviceArray<FrameInfo> infos_;
};

/// The samples of such frames there, which are a shard. They grow by hard negatives between two rounds of trees.
class DeviceSamples {
 public:
  /// `leads` is true for one shard of the set. `set` must outlive this object and not change.
  DeviceSamples(const TrainingSet& set, std::shared_ptr<const DeviceFrames> frames, bool leads = true);

  const std::shared_ptr<Device>& device() const { return frames_->device(); }
  TiledFrames frames() const { return frames_->describe(); }
  Samples describe() const { return {pixels_.data(), scales_.data(), static_cast<std::uint32_t>(samples_.size())}; }
  const TrainingSet& set() const { return set_; }
  /// Returns the same samples in this machine's memory.
  std::span<const TrainingSample> here() const { return samples_; }
  /// Returns the set's counts if this shard leads and none otherwise, so that those of all shards add up.
  SampleCounts sample_counts() const;

 private:
  const TrainingSet& set_;
  std::shared_ptr<const DeviceFrames> frames_;
  std::span<const TrainingSample> samples_;
  bool leads_;
  DeviceArray<SamplePixel> pixels_;
  DeviceArray<SampleScale> scales_;
};

/// A stream with what nearly all work on it needs.
class TrainStream {
 public:
  explicit TrainStream(std::shared_ptr<Device> device) : device_(std::move(device)), stream_(device_->make_stream()) {}

  const std::shared_ptr<Device>& device() const { return device_; }
  Stream& operator*() const { return *stream_; }
  Stream* operator->() const { return stream_.get(); }

  /// Makes room for `count` values; what was there goes if there was not enough.
  template <class T>
  void fit(DeviceArray<T>& array, std::size_t count) const {
    array.fit(device_, count);
  }
  /// Copies values there. They must stay until `wait`.
  template <class T>
  void send(DeviceArray<T>& array, const std::vector<T>& values) const {
    fit(array, values.size());
    if (!values.empty()) stream_->copy_to_device(array.data(), values.data(), values.size() * sizeof(T));
  }
  /// Returns the first `count` values when all that was asked before is done.
  template <class T>
  std::vector<T> fetch(const DeviceArray<T>& array, std::size_t count) const {
    std::vector<T> values(count);
    if (count > 0) stream_->copy_to_host(values.data(), array.data(), count * sizeof(T));
    stream_->wait();
    return values;
  }
  /// Makes room for `count` values and sets all to 0.
  template <class T>
  void clear(DeviceArray<T>& array, std::size_t count) const {
    fit(array, count);
    if (count > 0) stream_->clear(array.data(), count * sizeof(T));
  }
  /// Runs a kernel with a thread for each of `count`.
  void launch(const KernelCall& call, std::size_t count) const {
    if (count > 0) launch_blocks(call, (count + kThreads - 1) / kThreads);
  }
  /// Runs a kernel on so many blocks.
  void launch_blocks(const KernelCall& call, std::size_t blocks, unsigned blocks_y = 1) const {
    if (blocks > 0) stream_->launch(call, {static_cast<unsigned>(blocks), blocks_y, kThreads});
  }

  static constexpr unsigned kThreads = 256;

 private:
  std::shared_ptr<Device> device_;
  std::unique_ptr<Stream> stream_;
};

}  // namespace vesalius::gpu
