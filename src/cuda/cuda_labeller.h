#pragma once

#include "vesalius/forest/make_labeller.h"

namespace vesalius::gpu {

/// Returns the kind of device "cuda" for make_labeller: this machine's cards. Its labellers throw DeviceError where
/// this build has no kernels for cards.
LabellerDevice cuda_labeller();

}  // namespace vesalius::gpu
