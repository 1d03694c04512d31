#pragma once

#include <memory>
#include <utility>

#include "cuda/simulated_device.h"
#include "cuda_train/train_kernels.cuh"
// Behind the kernels.
#include "cuda/compiled_kernels.cuh"

namespace vesalius::test {

/// Returns what stands for a card that trains.
inline std::shared_ptr<gpu::SimulatedDevice> simulated_training(gpu::SimulatedDeviceOptions options = {}) {
  return std::make_shared<gpu::SimulatedDevice>(std::move(options), gpu::compiled(gpu::TrainKernels{}));
}

}  // namespace vesalius::test
