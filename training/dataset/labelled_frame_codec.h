#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "io/files/byte_stream.h"
#include "vesalius/frame.h"
#include "vesalius/image.h"

namespace vesalius {

/// A frame of a labelled dataset and its origin.
struct DatasetFrame {
  std::uint64_t index = 0;
  std::uint64_t seed = 0;  ///< seed of the run that made it
  LabelledFrame labelled;
};

inline constexpr std::size_t kMostJoints = 255;

/// Throws Error if one of these holds: pictures differ in size; a label is not below `part_count`; a person in the
/// picture has no parts, or a person has another number of parts; a part centre is infinite (NaN is allowed and means
/// that the body has no such part); people differ in their number of joints, or have more than 255; a joint is not
/// finite; there are postures, but not one of at most 255 bytes for each person; the upward direction is not of unit
/// length; the camera's height or pose is not finite, or the pose no rigid motion; the name is longer than 255 bytes.
void check_truth(const LabelledFrame& labelled, int part_count);

/// Encodes one frame without loss (docs/formats.md). It may be called from several threads. Throws Error as
/// `check_truth` does and names the frame's index.
std::string encode_frame(const DatasetFrame& frame, int part_count);

/// Decodes one frame; colour is left out if `with_colour` is false. Throws Error naming `name` for bytes that hold no
/// frame. It never allocates more memory than pictures of 64 Mpixel need.
DatasetFrame decode_frame(std::string_view bytes, int part_count, const std::string& name, bool with_colour = true);

// Lossless compression of a frame's pictures. Reading needs the size of the picture, allocates no more memory than that
// size needs, and throws Error for bytes that do not decode to it.

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
