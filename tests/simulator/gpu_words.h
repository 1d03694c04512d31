#pragma once

// The words of kernels (cuda/gpu.h) as calls of the simulator: to be included before the kernels' text.

#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>

#include "simulator/simulator.h"

#define GPU_KERNEL inline
#define GPU_FUNCTION inline
#define GPU_SHARED(type, name, count) \
  const ::vesalius::gpu::SharedArray<type> name = ::vesalius::gpu::Simulator::shared<type>(__LINE__, count)
// NOLINTNEXTLINE(bugprone-macro-parentheses): a name
#define GPU_PHASE(thread) for (const unsigned thread : ::vesalius::gpu::Simulator::phase())
#define GPU_LAST_PHASE(thread) GPU_PHASE(thread)
#define GPU_UNROLL

namespace vesalius::gpu {

GPU_FUNCTION unsigned block_x() { return Simulator::block_x(); }
GPU_FUNCTION unsigned block_y() { return Simulator::block_y(); }
GPU_FUNCTION unsigned threads_in_block() { return Simulator::threads_in_block(); }
// A place of shared memory is a T&, so that its bounds were checked; a place of global memory a pointer.
template <class T>
T add(T* place, T value) {
  return std::atomic_ref<T>(*place).fetch_add(value, std::memory_order_relaxed);
}
GPU_FUNCTION void raise(std::int32_t* place, std::int32_t value) {
  std::atomic_ref<std::int32_t> at(*place);
  std::int32_t there = at.load(std::memory_order_relaxed);
  while (there < value && !at.compare_exchange_weak(there, value, std::memory_order_relaxed)) {
  }
}
GPU_FUNCTION std::int32_t nearest(float x) { return static_cast<std::int32_t>(std::nearbyint(x)); }
GPU_FUNCTION std::int32_t rounded(float x) { return static_cast<std::int32_t>(std::lround(x)); }
GPU_FUNCTION float logarithm(float x) { return std::log(x); }
GPU_FUNCTION float bits_as_float(std::int32_t x) { return std::bit_cast<float>(x); }
GPU_FUNCTION std::int32_t float_as_bits(float x) { return std::bit_cast<std::int32_t>(x); }

}  // namespace vesalius::gpu
