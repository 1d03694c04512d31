#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cuda/kernel_call.h"
#include "cuda/launch_shape.h"

namespace vesalius::gpu {

/// A point in a stream's work whose time is taken.
class Event {
 public:
  virtual ~Event() = default;
  /// Returns the milliseconds from `earlier`, an event of the same device. Both must have been reached (Stream::wait).
  virtual double ms_since(const Event& earlier) const = 0;
};

/// Work that a device does in order, beside what other streams do. Memory of this machine that is copied from or to
/// must stay as it is until `wait` returns. All throw DeviceError if the device fails.
class Stream {
 public:
  virtual ~Stream() = default;
  virtual void copy_to_device(void* to, const void* from, std::size_t bytes) = 0;
  virtual void copy_to_host(void* to, const void* from, std::size_t bytes) = 0;
  /// Sets bytes of the device's memory to 0.
  virtual void clear(void* at, std::size_t bytes) = 0;
  /// The device was opened for this kernel.
  virtual void launch(const KernelCall& call, const LaunchShape& shape) = 0;
  virtual void record(Event& event) = 0;
  /// Returns when all is done.
  virtual void wait() = 0;
};

/// A card, or what stands for one (simulated_device.h). It may be used from several threads at once, a stream only from
/// one at a time.
class Device {
 public:
  virtual ~Device() = default;
  /// Returns how messages and `vesalius info` call it.
  virtual std::string name() const = 0;
  /// Returns memory of the device, aligned to 256 bytes. Throws DeviceError, which says how much was asked for, if
  /// there is not enough.
  virtual void* allocate(std::size_t bytes) = 0;
  virtual void release(void* at) noexcept = 0;
  /// Returns memory of this machine that copies reach without help of the processor.
  virtual void* allocate_pinned(std::size_t bytes) = 0;
  virtual void release_pinned(void* at) noexcept = 0;
  virtual std::unique_ptr<Stream> make_stream() = 0;
  virtual std::unique_ptr<Event> make_event() = 0;
};

/// Memory of a device, or pinned memory of this machine, for values of a type.
template <class T, bool kPinned = false>
class DeviceArray {
 public:
  DeviceArray() = default;
  DeviceArray(std::shared_ptr<Device> device, std::size_t count) : device_(std::move(device)), count_(count) {
    if (count == 0) return;
    const std::size_t bytes = count * sizeof(T);
    values_ = static_cast<T*>(kPinned ? device_->allocate_pinned(bytes) : device_->allocate(bytes));
  }
  ~DeviceArray() {
    if (values_ == nullptr) return;
    kPinned ? device_->release_pinned(values_) : device_->release(values_);
  }
  DeviceArray(DeviceArray&& other) noexcept { swap(other); }
  DeviceArray& operator=(DeviceArray&& other) noexcept {
    swap(other);
    return *this;
  }

  /// Makes room for `count` values. What was there goes, before more is asked for, if there was not enough.
  void fit(const std::shared_ptr<Device>& device, std::size_t count) {
    if (count_ >= count) return;
    *this = {};
    *this = DeviceArray(device, count);
  }

  T* data() const { return values_; }
  std::size_t size() const { return count_; }
  std::size_t bytes() const { return count_ * sizeof(T); }

 private:
  void swap(DeviceArray& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(values_, other.values_);
    std::swap(count_, other.count_);
  }

  std::shared_ptr<Device> device_;
  T* values_ = nullptr;
  std::size_t count_ = 0;
};

template <class T>
using PinnedArray = DeviceArray<T, true>;

/// Starts to copy values, which must stay as they are until `stream` is waited for, to new memory of a device.
template <class T>
DeviceArray<T> uploaded(const std::shared_ptr<Device>& device, Stream& stream, const std::vector<T>& values) {
  DeviceArray<T> array(device, values.size());
  if (!values.empty()) stream.copy_to_device(array.data(), values.data(), array.bytes());
  return array;
}

}  // namespace vesalius::gpu
