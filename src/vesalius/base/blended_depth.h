#pragma once

#include <optional>
#include <string>

#include "vesalius/image.h"
#include "vesalius/people_options.h"

namespace vesalius {

/// Removes the ramps that pictures have around holes where somebody resized them by interpolation: a hole reads 0, so
/// readings beside it came out too near. A reading goes if it is beside a hole and has less than `least_share` of the
/// reading on its other side; then those beside it are asked, up to three pixels from the hole. Returns nothing if all
/// readings stay.
std::optional<DepthImage> without_blended(const DepthImage& depth, const BlendOptions& options);

}  // namespace vesalius
