#pragma once

#include <memory>
#include <vector>

#include "cuda/device.h"
#include "cuda/kernels.h"
#include "vesalius/base/pool.h"
#include "vesalius/network/run_network.h"

namespace vesalius::gpu {

/// A network in a device's memory: bit for bit what NetworkRunner gives. Runs from several threads go on beside each
/// other, each in a stream and in memory of its own, which is kept for the next.
class DeviceNetwork {
 public:
  /// Throws what check(Network) throws and DeviceError if the device fails.
  DeviceNetwork(const Network& network, int parts, std::shared_ptr<Device> device);

  /// As NetworkRunner::run. Throws DeviceError if the device fails; `out` is then undefined.
  void run(const NetworkInput& input, NetworkResult& out) const;

 private:
  struct Layer {
    Convolution convolution;  ///< without its numbers, which are on the device
    DeviceArray<FourWords> weights;
    DeviceArray<float> scale, offset;
  };
  struct Workspace {
    std::vector<DeviceArray<std::uint8_t>> pictures = {};  ///< numbered as in Convolution::input
    std::unique_ptr<Stream> stream = nullptr;              // the last: it ends before the memory that it uses
  };

  std::vector<NetworkValues> make_room(int width, int height, Workspace& space) const;

  std::shared_ptr<Device> device_;
  std::vector<NetworkPicture> pictures_;
  std::vector<Layer> layers_;
  std::size_t classes_of_, person_of_;  ///< pictures
  std::size_t centres_of_;              ///< picture; 0: none
  mutable Pool<Workspace> spaces_;
};

}  // namespace vesalius::gpu
