#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "train/training_sample.h"
#include "vesalius/base/body_model.h"
#include "vesalius/base/frame.h"
#include "vesalius/base/options.h"
#include "vesalius/base/random.h"

namespace vesalius {

/// Which pixels of a frame are learned from: only pixels with a reading, whatever the options say.
struct SampleOptions {
  int pixels_per_frame = 370;
  float background_share = 0.5F;  ///< of a frame's pixels; 0 trains without background class
  float near_share = 0.4F;        ///< of the background pixels: within `near_px` of a person
  int near_px = 40;
  float balanced_share = 0.5F;   ///< of the body pixels: every part in view equally often, the rest by visible area
  int hard_pool = 300;           ///< background pixels a frame offers to the search for hard negatives; empty frames 4x
  float hard_share = 0.5F;       ///< most hard negatives, as a multiple of the ordinary background samples
  float held_out_share = 0.02F;  ///< of the frames: learned from by no tree, to measure accuracy on
};
void visit_options(const std::string& prefix, SampleOptions& options, OptionVisitor& visitor);

/// What one frame gives to a training set. `TrainingSample::frame` is not set.
struct DrawnSamples {
  std::vector<TrainingSample> samples;      ///< to learn from
  std::vector<TrainingSample> pool;         ///< background to search for hard negatives
  std::vector<std::uint64_t> class_pixels;  ///< readings of each class, the background last
};

/// Draws pixels with a reading, with replacement. A frame without people gives only its background share, a frame
/// without background only its body share. `where` names the frame in errors. Throws Error for images that differ in
/// size and for labels that the body lacks.
DrawnSamples draw_samples(const LabelledFrame& labelled, const BodyModel& body, const SampleOptions& options,
                          Random& random, const std::string& where);

}  // namespace vesalius
