#include <fmt/format.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "console/satellites.h"
#include "cuda/cuda_device.h"
#include "cuda/cuda_labeller.h"
#include "vesalius/error.h"

namespace vesalius::cli {
namespace {

/// Returns what `vesalius info` says of cards.
std::vector<std::pair<std::string, std::string>> facts() {
  if (!gpu::has_cuda()) return {{"kernels", "absent"}};
  std::vector<std::pair<std::string, std::string>> found{{"kernels", "present"}};
  try {
    int number = 0;
    for (const gpu::CudaFacts& card : gpu::cuda_devices()) {
      found.emplace_back(
          fmt::format("cuda:{}", number++),
          fmt::format("{}, {:.0f} GiB, {} multiprocessors, compute capability {}.{}", card.name,
                      double(card.memory_bytes) / (1U << 30U), card.multiprocessors, card.major, card.minor));
    }
  } catch (const DeviceError& e) {
    found.emplace_back("cards", e.what());
  }
  return found;
}

}  // namespace

Satellite cuda_satellite() {
  return {.name = "cuda",
          .commands = {},
          .facts = facts,
          .devices = {gpu::cuda_labeller()},
          .has_kernels = gpu::has_cuda()};
}

}  // namespace vesalius::cli
