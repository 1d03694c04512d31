#pragma once

// The words that kernels are written in (kernels.cuh). nvcc and hipcc read them as CUDA, any C++ compiler as calls of
// the simulator (simulator.h), so that one text runs on cards and, bit for bit the same, in tests without one.
//
// A kernel is the text of a whole block, made of phases. `GPU_PHASE(thread) {...}` runs its body once for every thread
// of the block and ends in a barrier; `GPU_LAST_PHASE` has no barrier behind it. `continue` ends a thread's part of a
// phase. What one phase leaves for the next is in shared memory. Everything outside of phases must be the same for all
// threads of a block.
//
//   GPU_KERNEL                       before a kernel
//   GPU_FUNCTION                     before a function that kernels call
//   GPU_SHARED(type, name, count)    an array in the block's shared memory, undefined at first
//   block_x() block_y()              the block's place among all
//   threads_in_block()
//   add(place, value)                atomic; returns what was there before
//   raise(place, value)              atomic; the larger of both
//   nearest(x)                       the nearest integer, the even one of two
//   rounded(x)                       the nearest integer, of two the one further from zero
//   logarithm(x)                     for display only: its last bits differ from card to card
//   bits_as_float(x)

#include <cstdint>

#if defined(__CUDACC__) || defined(__HIPCC__)

#define GPU_KERNEL static __global__
#define GPU_FUNCTION __device__ inline
#define GPU_SHARED(type, name, count) __shared__ type name[count]
#define GPU_PHASE(thread) for (unsigned thread = threadIdx.x, once_ = 1; once_ != 0; once_ = 0, __syncthreads())
#define GPU_LAST_PHASE(thread) for (unsigned thread = threadIdx.x, once_ = 1; once_ != 0; once_ = 0)

namespace vesalius::gpu {

GPU_FUNCTION unsigned block_x() { return blockIdx.x; }
GPU_FUNCTION unsigned block_y() { return blockIdx.y; }
GPU_FUNCTION unsigned threads_in_block() { return blockDim.x; }
GPU_FUNCTION std::uint32_t add(std::uint32_t* place, std::uint32_t value) { return atomicAdd(place, value); }
GPU_FUNCTION std::int32_t add(std::int32_t* place, std::int32_t value) { return atomicAdd(place, value); }
GPU_FUNCTION void add(std::uint64_t* place, std::uint64_t value) {
  static_assert(sizeof(unsigned long long) == sizeof(std::uint64_t));
  atomicAdd(reinterpret_cast<unsigned long long*>(place), static_cast<unsigned long long>(value));
}
GPU_FUNCTION void raise(std::int32_t* place, std::int32_t value) { atomicMax(place, value); }
GPU_FUNCTION std::int32_t rounded(float x) { return static_cast<std::int32_t>(roundf(x)); }
GPU_FUNCTION float logarithm(float x) { return logf(x); }
GPU_FUNCTION std::int32_t nearest(float x) { return __float2int_rn(x); }
GPU_FUNCTION float bits_as_float(std::int32_t x) { return __int_as_float(x); }
GPU_FUNCTION std::int32_t float_as_bits(float x) { return __float_as_int(x); }

}  // namespace vesalius::gpu

#else

#include <bit>
#include <cmath>

#include "cuda/simulator.h"

#define GPU_KERNEL inline
#define GPU_FUNCTION inline
#define GPU_SHARED(type, name, count) \
  const ::vesalius::gpu::SharedArray<type> name = ::vesalius::gpu::Simulator::shared<type>(__LINE__, count)
// NOLINTNEXTLINE(bugprone-macro-parentheses): a name
#define GPU_PHASE(thread) for (const unsigned thread : ::vesalius::gpu::Simulator::phase())
#define GPU_LAST_PHASE(thread) GPU_PHASE(thread)

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

#endif
