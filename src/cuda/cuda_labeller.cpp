#include "cuda/cuda_labeller.h"

#include <memory>

#include "cuda/cuda_device.h"
#include "cuda/device_labeller.h"

namespace vesalius::gpu {

LabellerDevice cuda_labeller() {
  return {"cuda", [](const Forest& forest, int number) -> std::shared_ptr<const Labeller> {
            return std::make_shared<DeviceLabeller>(forest, open_cuda_device(number));
          }};
}

}  // namespace vesalius::gpu
