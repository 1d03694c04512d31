#pragma once

#include <string>

#include "vesalius/base/options.h"
#include "vesalius/base/random.h"
#include "vesalius/image.h"

namespace vesalius::synth {

/// How far colour cameras, what records them and their place beside the depth camera may differ from a good one. Each
/// is drawn for every camera.
struct ColourCameraOptions {
  float exposure_max = 0.F;  ///< greatest error of the exposure either way, stops
  float balance_max = 0.F;   ///< greatest share by which red gains and blue loses, or the reverse
  float noise_max = 1.F;     ///< greatest factor of the noise, as in weak light
  float blur_max_px = 0.F;   ///< greatest standard deviation of the blur, pixels
  int jpeg_worst = 100;      ///< worst quality of JPEG; 100: none is kept as JPEG
  int offset_max_px = 0;     ///< how far colour may lie off depth, along rows and along columns, pixels
  friend bool operator==(const ColourCameraOptions&, const ColourCameraOptions&) = default;
};

void visit_options(const std::string& prefix, ColourCameraOptions& options, OptionVisitor& visitor);

/// One colour camera as it was drawn.
struct ColourCamera {
  float red_gain = 1.F, green_gain = 1.F, blue_gain = 1.F;
  float noise = 1.F;        ///< factor of the noise
  float blur_px = 0.F;      ///< standard deviation
  int jpeg = 100;           ///< quality; 100: not kept as JPEG
  int right = 0, down = 0;  ///< how far colour lies off depth, pixels
};

/// Draws a camera: stops, shares, widths, qualities and offsets evenly, the factor evenly in its logarithm.
ColourCamera draw_colour_camera(const ColourCameraOptions& options, Random random);

/// Applies what the lens and the exposure do, which comes before the noise: blur, then the gains.
void expose(const ColourCamera& camera, ColourImage& colour);

/// Adds a colour camera's exposure, white balance and pixel noise: gains of about 15 and 4 %, sigma 2 to 6 of 255 times
/// `louder`.
void add_colour_noise(ColourImage& colour, Random random, float louder = 1.F);
/// The same with exposure and white balance from `look`, which a recording keeps, and the pixels' noise from `noise`.
void add_colour_noise(ColourImage& colour, Random look, Random noise, float louder = 1.F);

/// Applies what comes after it: JPEG and back, then the offset, with the border repeated. Throws Error if libjpeg
/// fails.
void record(const ColourCamera& camera, ColourImage& colour);

}  // namespace vesalius::synth
