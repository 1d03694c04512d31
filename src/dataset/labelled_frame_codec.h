#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "vesalius/base/frame.h"

namespace vesalius {

/// A frame of a labelled dataset and where it came from.
struct DatasetFrame {
  std::uint64_t index = 0;
  std::uint64_t seed = 0;  ///< of the run that made it
  LabelledFrame labelled;
};

inline constexpr std::size_t kMostJoints = 255;

/// Throws Error where pictures differ in size, a label is not below `part_count`, a person in the picture has no
/// parts, a person has another number of parts, a part centre is infinite (NaN: the body has no such part), some but
/// not all people have joints or other numbers of them or more than 255, a joint is not finite, or the name is longer
/// than 255 bytes.
void check_truth(const LabelledFrame& labelled, int part_count);

/// The bytes of one frame (docs/formats.md), lossless. Safe to call from several threads. Throws Error as
/// `check_truth` does, naming the frame's index.
std::string encode_frame(const DatasetFrame& frame, int part_count);

/// Returns the frame that these bytes hold, without its colour where that is not wanted. Throws Error naming `name` for
/// bytes that hold none, and asks for no more memory than pictures of 64 Mpixel need.
DatasetFrame decode_frame(std::string_view bytes, int part_count, const std::string& name, bool with_colour = true);

}  // namespace vesalius
