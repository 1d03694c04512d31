#pragma once

#include <memory>

#include "cuda/device.h"
#include "vesalius/model.h"

namespace vesalius::gpu {

/// Returns a labeller of the model's forest or network on a device: bit for bit what the processor gives. Throws Error
/// for an inconsistent one and DeviceError if the device cannot take it.
std::shared_ptr<const Labeller> make_device_labeller(const Model& model, std::shared_ptr<Device> device);

/// Returns the kind of device "cuda" for on_device: this machine's cards. Its labellers throw DeviceError where
/// this build has no kernels for cards.
LabellerDevice cuda_labeller();

}  // namespace vesalius::gpu
