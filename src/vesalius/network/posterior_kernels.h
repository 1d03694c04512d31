#pragma once

#include <cstdint>

#include "vesalius/image.h"
#include "vesalius/labeller.h"

namespace vesalius {

/// Writes to `shares` the probabilities, in 1/`whole` and rounded, for which `count` logits of each of `pixels` pixels
/// stand (kLogitUnit). At least 2 classes; the last is the background. The same for every instruction set.
void softmax_in_steps(const std::int16_t* logits, int pixels, int count, int whole, std::uint16_t* shares);

/// Writes row `v` of posteriors of all pixels, made of `half`, those of every second pixel of every second row. Pixels
/// between take the mean of those around them whose depth is like theirs, or else that of the nearest depth. `half` is
/// settled where nothing but the background is possible. The same for every instruction set.
void enlarge_row(const DepthImage& depth, const Posteriors& half, int v, Posteriors& out);

}  // namespace vesalius
