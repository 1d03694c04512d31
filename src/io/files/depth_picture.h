#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "vesalius/image.h"

namespace vesalius {

/// Depth as a picture has it; one of the two is filled.
struct DepthPicture {
  Image<std::uint16_t> whole;  ///< in whatever unit, 0 = no reading
  Image<float> real;           ///< metres where nobody says otherwise; not finite or not positive = no reading

  int width() const { return whole.empty() ? real.width() : whole.width(); }
  int height() const { return whole.empty() ? real.height() : whole.height(); }
};

/// Extensions of pictures of depth, in lower case, those that are taken first in front.
const std::vector<std::string>& depth_extensions();
/// Extensions of pictures that may be of depth, but are not read.
const std::vector<std::string>& unread_depth_extensions();

/// Returns what to do about a file of an extension that is not read.
std::string unread_advice(const std::string& extension);

/// Reads a PNG or PGM of 16 bits, a PFM, or an array of NumPy (.npy) of whole numbers or of numbers with a fraction:
/// rows of columns; with libavcodec TIFF of 16 bits and OpenEXR too. Throws Error naming `name` if it is damaged, too
/// large, or something else.
DepthPicture decode_depth(std::string_view bytes, const std::string& name);
DepthPicture read_depth(const std::string& path);

/// Returns false for a file whose first bytes are those of a picture that `read_depth` refuses: of 8 bits, of colours.
bool may_be_depth(const std::string& path);

/// Returns depth in millimetres, 0 = no reading. What is over 65535 mm does not fit and has none; whole numbers of
/// 65535 are no readings of programs that write such (7-Scenes). `units_per_m` is that of whole numbers and, where
/// `of_real` says so, of numbers with a fraction, which are metres otherwise.
DepthImage to_millimetres(const DepthPicture& picture, float units_per_m, bool of_real);

}  // namespace vesalius
