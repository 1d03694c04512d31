#pragma once

#include <functional>
#include <vector>

#include "vesalius/image.h"

namespace vesalius {

/// Returns `flat` without those of its connected pieces that are rather part of a body: small ones that end by
/// themselves. A piece of floor between two legs is small too, but ends where the legs hide it. Pieces whose squared
/// depths, in mm^2, add up to `surely_large_mm2` stay. Whether another is large, `large` says, which gets the row-major
/// indices of its pixels.
Mask without_body_pieces(const DepthImage& depth, const Mask& flat, double surely_large_mm2,
                         const std::function<bool(const std::vector<int>&)>& large);

}  // namespace vesalius
