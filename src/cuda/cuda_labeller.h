#pragma once

#include "vesalius/model.h"

namespace vesalius::gpu {

/// Returns the kind of device "cuda" for on_device: this machine's cards. Its labellers throw DeviceError where
/// this build has no kernels for cards.
LabellerDevice cuda_labeller();

}  // namespace vesalius::gpu
