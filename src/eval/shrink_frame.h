#pragma once

#include <vector>

#include "vesalius/detect.h"
#include "vesalius/frame.h"
#include "vesalius/image.h"

namespace vesalius {

/// Every `factor`-th pixel of every `factor`-th row, from the first on, and the camera of these. Rows and columns that
/// fill no whole step are left out. Throws Error for a factor below 1 or a frame that it leaves nothing of.
Frame shrink(const Frame& frame, int factor);

/// Likewise of a mask or labels.
Image<std::uint8_t> shrink(const Image<std::uint8_t>& image, int factor);

/// What a shrunk frame gave, on the grid of the whole one: each pixel takes the value of the one kept of its step.
Image<std::uint8_t> enlarge(const Image<std::uint8_t>& image, int factor, int width, int height);

/// The same for all that was found in a shrunk frame; positions in 3-D are what they are.
void enlarge(std::vector<Person>& people, int factor, int width, int height);
/// Of a trace the labels and the candidates' masks, which evaluation looks at.
void enlarge(Trace& trace, int factor, int width, int height);

}  // namespace vesalius
