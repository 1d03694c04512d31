#pragma once

// The words that kernels are written in (kernels.cuh). nvcc and hipcc read them as CUDA, any C++ compiler as calls of
// the simulator (tests/simulator), so that one text runs on cards and, bit for bit the same, in tests without one.
//
// A kernel is the text of a whole block, made of phases. `GPU_PHASE(thread) {...}` runs its body once for every thread
// of the block and ends in a barrier; `GPU_LAST_PHASE` has no barrier behind it. `continue` ends a thread's part of a
// phase. What one phase leaves for the next is in shared memory. Everything outside of phases must be the same for all
// threads of a block.
//
//   GPU_KERNEL                       before a kernel
//   GPU_FUNCTION                     before a function that kernels call
//   GPU_SHARED(type, name, count)    an array in the block's shared memory, undefined at first
//   GPU_UNROLL                       before a loop whose body is to be written out
//   block_x() block_y()              the block's place among all
//   threads_in_block()
//   add(place, value)                atomic; returns what was there before
//   raise(place, value)              atomic; the larger of both
//   nearest(x)                       the nearest integer, the even one of two
//   rounded(x)                       the nearest integer, of two the one further from zero
//   logarithm(x)                     for display only: its last bits differ from card to card
//   bits_as_float(x)
//   add_products(sum, values, weights)   four bytes of 0 to 255 times four with a sign

#include <cstdint>

#if defined(__HIPCC__)
#include <hip/hip_runtime.h>
#endif

#if defined(__CUDACC__) || defined(__HIPCC__)

#define GPU_KERNEL static __global__
#define GPU_FUNCTION __device__ inline
#define GPU_SHARED(type, name, count) __shared__ type name[count]
#define GPU_PHASE(thread) for (unsigned thread = threadIdx.x, once_ = 1; once_ != 0; once_ = 0, __syncthreads())
#define GPU_LAST_PHASE(thread) for (unsigned thread = threadIdx.x, once_ = 1; once_ != 0; once_ = 0)
#define GPU_UNROLL _Pragma("unroll")

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

#elif !defined(GPU_KERNEL)
#error \
    "kernels need the words of whoever runs them before their text: nvcc's, hipcc's or the simulator's (simulator/gpu_words.h)"
#endif

namespace vesalius::gpu {

GPU_FUNCTION std::int32_t add_products(std::int32_t sum, std::uint32_t values, std::uint32_t weights) {
#if defined(__CUDA_ARCH__)  // CUDA has no name for the instruction with one sign
  asm("dp4a.u32.s32 %0, %1, %2, %0;" : "+r"(sum) : "r"(values), "r"(weights));
#else
  const auto product = [&](int at) { return int(values >> at & 255U) * static_cast<std::int8_t>(weights >> at); };
  sum += product(0) + product(8) + product(16) + product(24);
#endif
  return sum;
}

}  // namespace vesalius::gpu
