#pragma once

#include <string>

#include "io/sources/pcd_header.h"
#include "vesalius/base/frame.h"

namespace vesalius {

/// Returns the frame as an organised PCD file of x y z, and rgb where the frame has colour; points are NaN where it has
/// no depth. Reading the file gives the same depth and colour.
std::string serialise_pcd(const Frame& frame, PcdEncoding encoding);

}  // namespace vesalius
