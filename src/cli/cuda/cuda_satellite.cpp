#include <fmt/format.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "cli/satellites.h"
#include "cuda/cuda_device.h"
#include "cuda/cuda_labeller.h"
#ifdef VESALIUS_HAS_TRAINING
#include "cuda/train/device_executor.h"
#endif
#include "vesalius/base/error.h"

namespace vesalius::cli {
namespace {

/// Returns what `vesalius info` says of cards.
std::vector<std::pair<std::string, std::string>> facts() {
  if (!gpu::has_cuda()) return {{"kernels", "absent"}};
  std::vector<std::pair<std::string, std::string>> found{{"kernels", "present"}};
  try {
    int number = 0;
    for (const gpu::CudaFacts& card : gpu::cuda_devices()) {
      found.emplace_back(fmt::format("cuda:{}", number++),
                         fmt::format("{}, {:.0f} GiB, {} multiprocessors, compute capability {}.{}", card.name,
                                     static_cast<double>(card.memory_bytes) / (1U << 30U), card.multiprocessors,
                                     card.major, card.minor));
    }
  } catch (const DeviceError& e) {
    found.emplace_back("cards", e.what());
  }
  return found;
}

#ifdef VESALIUS_HAS_TRAINING
MakeExecutor open_trainer(const std::vector<int>& numbers) {
  std::vector<std::shared_ptr<gpu::Device>> cards;
  for (const int number : numbers) cards.push_back(gpu::open_cuda_device(number));
  return [cards](const std::vector<TrainingSet*>& sets, int trees_at_once) {
    return std::make_unique<gpu::DeviceExecutor>(sets, cards, trees_at_once);
  };
}
#endif

}  // namespace

Satellite cuda_satellite() {
  Satellite satellite{.name = "cuda", .commands = {}, .facts = facts, .devices = {gpu::cuda_labeller()}};
#ifdef VESALIUS_HAS_TRAINING
  satellite.trainers = {{"cuda", open_trainer}};
#endif
  return satellite;
}

}  // namespace vesalius::cli
