// What a build without a CUDA compiler has instead of train_kernels.cu.

#include "cuda_train/train_kernels.h"

namespace vesalius::gpu {

std::vector<CardKernel> train_kernels_on_cards() { return {}; }

}  // namespace vesalius::gpu
