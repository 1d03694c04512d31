#pragma once

#include <atomic>
#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "cuda/device.h"
#include "simulator/simulator.h"

namespace vesalius::gpu {

/// A kernel that is compiled for the simulator.
struct SimulatedKernel {
  const char* name = nullptr;
  void (*run_block)(const void* arguments) = nullptr;
};

/// Returns the kernels of a list; their text is read (gpu_words.h) where this is called.
template <class... Arguments>
std::vector<SimulatedKernel> simulated_kernels(KernelList<Arguments...> /*which*/) {
  return {{Arguments::kName, [](const void* told) { run_kernel(*static_cast<const Arguments*>(told)); }}...};
}

/// Returns the kernels of labelling.
std::vector<SimulatedKernel> simulated_label_kernels();

struct SimulatedDeviceOptions {
  SimulatorOptions simulator = {};
  std::size_t memory_bytes = std::size_t{8} << 30U;
  int lost_after = -1;             ///< operations of streams after which the device fails for good; below 0 never
  std::string faulty_kernel = {};  ///< where the simulator's faults are planted; empty: everywhere
  int columns_too_many = 0;        ///< planted fault: by how much probes may leave the picture to the right
};

/// The host's twin of a card: kernels run in the simulator. A stream does nothing before it is waited for, so that a
/// forgotten wait shows; memory starts as garbage, and what is written around it is noticed.
class SimulatedDevice : public Device, public std::enable_shared_from_this<SimulatedDevice> {
 public:
  explicit SimulatedDevice(SimulatedDeviceOptions options = {},
                           std::vector<SimulatedKernel> kernels = simulated_label_kernels())
      : options_(std::move(options)), kernels_(std::move(kernels)) {}

  std::string name() const override { return "simulated card"; }
  void* allocate(std::size_t bytes) override;
  void release(void* at) noexcept override;
  void* allocate_pinned(std::size_t bytes) override;
  void release_pinned(void* at) noexcept override;
  std::unique_ptr<Stream> make_stream() override;
  std::unique_ptr<Event> make_event() override;

  /// Bytes copied so far.
  std::size_t copied_to_device() const { return copied_to_; }
  std::size_t copied_to_host() const { return copied_from_; }
  std::size_t allocated_bytes() const;

 private:
  class SimulatedStream;
  struct Piece {
    std::vector<std::byte> all;  ///< with fences
    std::size_t bytes = 0;       ///< that are used
  };

  /// Throws std::logic_error unless all of it is within one piece of memory.
  void check_inside(const void* at, std::size_t bytes) const;
  /// Throws std::logic_error if something was written before or behind a piece of memory.
  void check_fences() const;
  void count_operation();
  void run(KernelCall call, const LaunchShape& shape) const;

  SimulatedDeviceOptions options_;
  std::vector<SimulatedKernel> kernels_;
  mutable std::mutex mutex_;
  std::map<const std::byte*, Piece> memory_;  ///< by the first byte that is used
  std::size_t allocated_ = 0;
  std::atomic<int> operations_ = 0;
  std::atomic<std::size_t> copied_to_ = 0, copied_from_ = 0;
};

}  // namespace vesalius::gpu
