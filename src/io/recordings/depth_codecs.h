#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "vesalius/image.h"

namespace vesalius {

/// Unpacks a depth picture that RVL packed (Wilson, "Fast Lossless Depth Image Compression", ISS 2017): runs of pixels
/// without and with a reading, the latter as differences, in groups of three bits. Throws Error naming `name` if there
/// are fewer pixels than `width` x `height`.
Image<std::uint16_t> unpack_rvl(std::string_view packed, int width, int height, const std::string& name);

/// Packs a depth picture in that way.
std::string pack_rvl(const Image<std::uint16_t>& depth);

/// Returns the PNG or RVL of compressedDepth: what follows 12 bytes, which some writers of PNG leave out.
std::string_view without_compressed_depth_head(std::string_view data);

/// Returns width and height of the data of compressedDepth that RVL packed, as they are stated; 0 where they are not.
std::pair<int, int> rvl_size(std::string_view data);

/// Unpacks the data of a sensor_msgs/CompressedImage of compressed_depth_image_transport. `format` is the message's,
/// e.g. "16UC1; compressedDepth png", "32FC1; compressedDepth", "16UC1; compressedDepth rvl". Returns depth in the
/// units of the picture that was packed; of 32FC1, whose inverse was stored, in millimetres; 0 is no reading. Throws
/// Error naming `name`.
Image<std::uint16_t> unpack_compressed_depth(std::string_view data, std::string_view format, const std::string& name);

}  // namespace vesalius
