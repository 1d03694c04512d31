#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cuda/device.h"

namespace vesalius::gpu {

/// Another device whose kernels and copies are timed one by one. For one stream at a time.
class TimedDevice : public Device, public std::enable_shared_from_this<TimedDevice> {
 public:
  explicit TimedDevice(std::shared_ptr<Device> device) : device_(std::move(device)) {}

  std::string name() const override { return device_->name(); }
  void* allocate(std::size_t bytes) override { return device_->allocate(bytes); }
  void release(void* at) noexcept override { device_->release(at); }
  void* allocate_pinned(std::size_t bytes) override { return device_->allocate_pinned(bytes); }
  void release_pinned(void* at) noexcept override { device_->release_pinned(at); }
  std::unique_ptr<Stream> make_stream() override;
  std::unique_ptr<Event> make_event() override { return device_->make_event(); }

  /// Returns the milliseconds that each kind of work has taken since the last call, in order of its first time.
  std::vector<std::pair<std::string, double>> take_times();

 private:
  class TimedStream;
  std::shared_ptr<Device> device_;
  std::vector<std::pair<std::string, double>> times_;
};

}  // namespace vesalius::gpu
