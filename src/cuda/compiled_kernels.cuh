#pragma once

// The kernels of a list as whoever compiles this makes them: for cards or for the simulator. To be included behind the
// text of the kernels, since it takes the address of each run_kernel.

#include <vector>

#include "cuda/gpu.h"
#include "cuda/kernel_call.h"

namespace vesalius::gpu {

#if defined(__CUDACC__) || defined(__HIPCC__)

template <class... Arguments>
std::vector<CardKernel> compiled(KernelList<Arguments...> /*which*/) {
  return {{Arguments::kName, reinterpret_cast<const void*>(static_cast<void (*)(Arguments)>(run_kernel))}...};
}

#else

template <class... Arguments>
std::vector<SimulatedKernel> compiled(KernelList<Arguments...> /*which*/) {
  return {{Arguments::kName, [](const void* told) { run_kernel(*static_cast<const Arguments*>(told)); }}...};
}

#endif

}  // namespace vesalius::gpu
