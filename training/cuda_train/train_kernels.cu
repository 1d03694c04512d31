#include "cuda_train/train_kernels.cuh"
// Behind the kernels.
#include "cuda/compiled_kernels.cuh"

namespace vesalius::gpu {

std::vector<CardKernel> train_kernels_on_cards() { return compiled(TrainKernels{}); }

}  // namespace vesalius::gpu
