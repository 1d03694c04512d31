#include "simulator/simulated_device.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "simulator/gpu_words.h"
#include "vesalius/error.h"
// Behind their words.
#include "cuda/kernels.cuh"

namespace vesalius::gpu {
namespace {

constexpr std::size_t kAlign = 256;
constexpr std::size_t kFence = 16384;  // as much as a block of threads is likely to write beyond its memory
constexpr auto kFenceByte = std::byte{0xFE};
constexpr auto kGarbage = std::byte{0xA5};

class SimulatedEvent : public Event {
 public:
  double ms_since(const Event& earlier) const override {
    return std::chrono::duration<double, std::milli>(at - dynamic_cast<const SimulatedEvent&>(earlier).at).count();
  }
  std::chrono::steady_clock::time_point at;
};

std::byte* aligned(std::byte* at) {
  const std::size_t over = reinterpret_cast<std::uintptr_t>(at) % kAlign;
  return at + (over != 0 ? kAlign - over : 0);
}

}  // namespace

/// Keeps what it is told to do until somebody waits.
class SimulatedDevice::SimulatedStream : public Stream {
 public:
  explicit SimulatedStream(std::shared_ptr<SimulatedDevice> device) : device_(std::move(device)) {}

  void copy_to_device(void* to, const void* from, std::size_t bytes) override {
    later([=, this] {
      device_->check_inside(to, bytes);
      std::memcpy(to, from, bytes);
      device_->copied_to_ += bytes;
    });
  }
  void copy_to_host(void* to, const void* from, std::size_t bytes) override {
    later([=, this] {
      device_->check_inside(from, bytes);
      std::memcpy(to, from, bytes);
      device_->copied_from_ += bytes;
    });
  }
  void clear(void* at, std::size_t bytes) override {
    later([=, this] {
      device_->check_inside(at, bytes);
      std::memset(at, 0, bytes);
    });
  }
  void launch(const KernelCall& call, const LaunchShape& shape) override {
    later([=, this] {
      device_->run(call, shape);
      device_->check_fences();
    });
  }
  void record(Event& event) override {
    later([&event] { dynamic_cast<SimulatedEvent&>(event).at = std::chrono::steady_clock::now(); });
  }
  void wait() override {
    const std::vector<std::function<void()>> work = std::exchange(work_, {});
    for (const auto& operation : work) operation();
  }

 private:
  void later(std::function<void()> operation) {
    device_->count_operation();
    work_.push_back(std::move(operation));
  }

  std::shared_ptr<SimulatedDevice> device_;
  std::vector<std::function<void()>> work_;
};

void* SimulatedDevice::allocate(std::size_t bytes) {
  const std::scoped_lock lock(mutex_);
  if (allocated_ + bytes > options_.memory_bytes) {
    throw DeviceError(name() + ": no room for " + std::to_string(bytes) + " bytes in its memory");
  }
  Piece piece{std::vector<std::byte>(bytes + kAlign + 2 * kFence, kFenceByte), bytes};
  std::byte* first = aligned(piece.all.data() + kFence);
  std::fill_n(first, bytes, options_.simulator.zeroed ? std::byte{0} : kGarbage);
  memory_.emplace(first, std::move(piece));
  allocated_ += bytes;
  return first;
}

void SimulatedDevice::release(void* at) noexcept {
  const std::scoped_lock lock(mutex_);
  const auto found = memory_.find(static_cast<const std::byte*>(at));
  if (found == memory_.end()) std::abort();
  allocated_ -= found->second.bytes;
  memory_.erase(found);
}

void* SimulatedDevice::allocate_pinned(std::size_t bytes) { return ::operator new(bytes); }
void SimulatedDevice::release_pinned(void* at) noexcept { ::operator delete(at); }

std::unique_ptr<Stream> SimulatedDevice::make_stream() { return std::make_unique<SimulatedStream>(shared_from_this()); }
std::unique_ptr<Event> SimulatedDevice::make_event() { return std::make_unique<SimulatedEvent>(); }

std::size_t SimulatedDevice::allocated_bytes() const {
  const std::scoped_lock lock(mutex_);
  return allocated_;
}

void SimulatedDevice::check_inside(const void* at, std::size_t bytes) const {
  const std::scoped_lock lock(mutex_);
  if (bytes == 0) return;
  const auto* first = static_cast<const std::byte*>(at);
  auto found = memory_.upper_bound(first);
  if (found != memory_.begin()) {
    --found;
    if (first + bytes <= found->first + found->second.bytes) return;
  }
  throw std::logic_error("a copy of " + std::to_string(bytes) + " bytes that are not in one piece of a card's memory");
}

void SimulatedDevice::check_fences() const {
  const std::scoped_lock lock(mutex_);
  const auto fence = [](std::byte b) { return b == kFenceByte; };
  for (const auto& [first, piece] : memory_) {
    const std::byte* all = piece.all.data();
    if (!std::all_of(all, first, fence) || !std::all_of(first + piece.bytes, all + piece.all.size(), fence)) {
      throw std::logic_error("a kernel wrote beside its memory");
    }
  }
}

void SimulatedDevice::count_operation() {
  const int count = ++operations_;
  if (options_.lost_after >= 0 && count > options_.lost_after) throw DeviceError(name() + ": the device was lost");
}

void SimulatedDevice::run(KernelCall call, const LaunchShape& shape) const {
  const std::string_view name = call.name();
  const auto kernel = std::ranges::find(kernels_, name, &SimulatedKernel::name);
  if (kernel == kernels_.end())
    throw std::logic_error("a kernel that the device was not made for: " + std::string(name));
  SimulatorOptions simulator = options_.simulator;
  if (!options_.faulty_kernel.empty() && name != options_.faulty_kernel) simulator.faults = {};
  if (name == WalkArguments::kName) {
    WalkArguments walk = *static_cast<const WalkArguments*>(call.arguments());
    walk.pictures.width += options_.columns_too_many;
    call = walk;
  }
  Simulator::run(shape, simulator, [&] { kernel->run_block(call.arguments()); });
}

std::vector<SimulatedKernel> simulated_label_kernels() { return simulated_kernels(LabelKernels{}); }

}  // namespace vesalius::gpu
