#include "cuda/cuda_labeller.h"

#include <utility>

#include "cuda/cuda_device.h"
#include "cuda/device_labeller.h"
#include "cuda/device_network.h"
#include "vesalius/network/network_labeller.h"

namespace vesalius::gpu {

std::shared_ptr<const Labeller> make_device_labeller(const Model& model, std::shared_ptr<Device> device) {
  if (model.network == nullptr) return std::make_shared<DeviceLabeller>(model.forest, std::move(device));
  const int parts = model.body.part_count();
  const auto network = std::make_shared<const DeviceNetwork>(*model.network, parts, std::move(device));
  return std::make_shared<NetworkLabeller>(
      [network](const NetworkInput& input, NetworkResult& out) { network->run(input, out); }, parts);
}

LabellerDevice cuda_labeller() {
  return {"cuda", [](const Model& model, int number) { return make_device_labeller(model, open_cuda_device(number)); }};
}

}  // namespace vesalius::gpu
