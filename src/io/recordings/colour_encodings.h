#pragma once

#include <string>
#include <string_view>

#include "vesalius/image.h"

namespace vesalius {

struct PictureMessage;

/// Returns whether raw pictures of this encoding are decoded as colour: RGB of 8 and 16 bits, grey, Bayer patterns,
/// packed and planar YUV, by their names in ROS, Foxglove and the SDKs of cameras; any case.
bool is_colour_encoding(std::string_view encoding);
/// Returns whether it is one without colours, as infrared has it too.
bool is_grey_encoding(std::string_view encoding);

/// Returns the colours of a raw picture, 16 bits cut to 8. Throws Error naming `name` if it is of another encoding or
/// not what it says.
ColourImage decode_raw_colour(const PictureMessage& picture, const std::string& name);

}  // namespace vesalius
