// What a build without a CUDA compiler says when it is asked for cards.

#include "cuda/cuda_device.h"
#include "vesalius/error.h"

namespace vesalius::gpu {
namespace {

[[noreturn]] void refuse() { throw DeviceError("cuda: this build has no kernels for cards; it was made without nvcc"); }

}  // namespace

bool has_cuda() { return false; }
std::vector<CudaFacts> cuda_devices() { refuse(); }
std::vector<CardKernel> label_kernels_on_cards() { return {}; }
std::shared_ptr<Device> open_cuda_device(int /*number*/, std::vector<CardKernel> /*kernels*/) { refuse(); }
std::vector<KernelFacts> kernel_facts(int /*number*/, const std::vector<CardKernel>& /*kernels*/) { refuse(); }

}  // namespace vesalius::gpu
