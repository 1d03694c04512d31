#pragma once

#include <string>

#include "io/sources/pcd_header.h"
#include "vesalius/base/frame.h"

namespace vesalius {

/// Returns the frame as an organised PCD file with x y z, and rgb if the frame has colour. Pixels without depth become
/// NaN points. Reading the file gives back the same depth and colour.
std::string serialise_pcd(const Frame& frame, PcdEncoding encoding);

}  // namespace vesalius
