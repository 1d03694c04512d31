#pragma once

// The kernels of a list as nvcc or hipcc makes them. To be included behind the text of the kernels, since it takes the
// address of each run_kernel.

#include <vector>

#include "cuda/kernel_call.h"

namespace vesalius::gpu {

template <class... Arguments>
std::vector<CardKernel> card_kernels(KernelList<Arguments...> /*which*/) {
  return {{Arguments::kName, reinterpret_cast<const void*>(static_cast<void (*)(Arguments)>(run_kernel))}...};
}

}  // namespace vesalius::gpu
