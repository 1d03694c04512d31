#pragma once

#include <memory>
#include <string>

#include "vesalius/forest/forest.h"
#include "vesalius/forest/label_pixels.h"

namespace vesalius {

/// Returns a labeller with `forest` on `device`, which can only be "cpu" so far. All programs get their labellers here,
/// so another device would be added in one place. Throws Error for an inconsistent forest and UsageError for a device
/// that this build or this machine does not have.
std::shared_ptr<const PixelLabeller> make_labeller(Forest forest, const std::string& device = "cpu");

}  // namespace vesalius
