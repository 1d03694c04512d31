#include "cuda_train/train_kernels.cuh"
// Behind the kernels.
#include "cuda/card_kernels.cuh"

namespace vesalius::gpu {

std::vector<CardKernel> train_kernels_on_cards() { return card_kernels(TrainKernels{}); }

}  // namespace vesalius::gpu
