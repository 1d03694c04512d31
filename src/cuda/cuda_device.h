#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "cuda/device.h"

namespace vesalius::gpu {

/// What is known of a card.
struct CudaFacts {
  std::string name;
  int major = 0, minor = 0;  ///< compute capability
  std::size_t memory_bytes = 0;
  int multiprocessors = 0;
};

/// Returns whether this build has kernels for cards: whether nvcc was there when it was made.
bool has_cuda();

/// Returns this machine's cards. Throws DeviceError, which says why, if there is none or the driver is too old.
std::vector<CudaFacts> cuda_devices();

/// Returns the kernels of labelling that are compiled for cards: none in a build without nvcc.
std::vector<CardKernel> label_kernels_on_cards();

/// Returns card `number`, from 0 on, for these kernels. Throws DeviceError if it is not there or too old for them.
std::shared_ptr<Device> open_cuda_device(int number, std::vector<CardKernel> kernels = label_kernels_on_cards());

/// What a kernel needs of a card, and how much of a multiprocessor it fills.
struct KernelFacts {
  std::string name;
  int registers = 0;
  std::size_t shared_bytes = 0, local_bytes = 0;
  float occupancy = 0.F;  ///< occupancy of blocks of 256 threads, 0-1
};

/// Returns this for kernels on card `number`. Throws DeviceError as open_cuda_device.
std::vector<KernelFacts> kernel_facts(int number, const std::vector<CardKernel>& kernels = label_kernels_on_cards());

}  // namespace vesalius::gpu
