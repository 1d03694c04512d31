#pragma once

#include "io/files/byte_stream.h"
#include "vesalius/image.h"

// Lossless compression of pictures in labelled datasets (docs/formats.md). Reading needs the size of the picture,
// allocates no more memory than that size needs, and throws Error for bytes that do not decode to it.
namespace vesalius {

/// Writes depth as ranks among the values that occur, each predicted from its neighbours. Depth that a sensor quantised
/// therefore takes few bytes.
void write_depth_plane(ByteWriter& out, const DepthImage& depth);
DepthImage read_depth_plane(ByteReader& in, int width, int height);

/// Writes labels or person indices, which have few values in large patches.
void write_byte_plane(ByteWriter& out, const Image<std::uint8_t>& plane);
Image<std::uint8_t> read_byte_plane(ByteReader& in, int width, int height);

void write_colour_plane(ByteWriter& out, const ColourImage& colour);
ColourImage read_colour_plane(ByteReader& in, int width, int height);
/// Skips a colour picture without decoding it.
void skip_colour_plane(ByteReader& in);

}  // namespace vesalius
