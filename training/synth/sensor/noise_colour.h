#pragma once

#include "vesalius/base/random.h"
#include "vesalius/image.h"

namespace vesalius::synth {

/// Adds a colour camera's exposure, white balance and pixel noise: gains of about 15 and 4 %, sigma 2 to 6 of 255.
void add_colour_noise(ColourImage& colour, Random random);
/// The same with exposure and white balance from `look`, which a recording keeps, and the pixels' noise from `noise`.
void add_colour_noise(ColourImage& colour, Random look, Random noise);

}  // namespace vesalius::synth
