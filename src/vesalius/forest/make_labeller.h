#pragma once

#include <memory>
#include <string>

#include "vesalius/forest/forest.h"
#include "vesalius/forest/label_pixels.h"

namespace vesalius {

/// Returns what labels pixels with `forest` on `device`: "cpu", the only one so far. All programs get their labellers
/// here, so that a further device is chosen in one place. Throws Error for an inconsistent forest and UsageError for a
/// device that this build or this machine does not have.
std::shared_ptr<const PixelLabeller> make_labeller(Forest forest, const std::string& device = "cpu");

}  // namespace vesalius
