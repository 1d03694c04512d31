#pragma once

#include <memory>
#include <utility>

#include "simulator/gpu_words.h"
#include "simulator/simulated_device.h"
// Behind their words.
#include "cuda_train/train_kernels.cuh"

namespace vesalius::test {

/// Returns what stands for a card that trains.
inline std::shared_ptr<gpu::SimulatedDevice> simulated_training(gpu::SimulatedDeviceOptions options = {}) {
  return std::make_shared<gpu::SimulatedDevice>(std::move(options), gpu::simulated_kernels(gpu::TrainKernels{}));
}

}  // namespace vesalius::test
