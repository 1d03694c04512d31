#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "train/messages/training_messages.h"
#include "vesalius/base/options.h"
#include "vesalius/base/random.h"
#include "vesalius/body_model.h"
#include "vesalius/frame.h"

namespace vesalius {

/// Options of the pixels from which a forest learns. Only pixels with a reading are used.
struct SampleOptions {
  int pixels_per_frame = 370;
  float background_share = 0.5F;  ///< share of a frame's pixels; 0 trains without background class
  float near_share = 0.4F;        ///< share of the background pixels that are within `near_px` of a person
  int near_px = 40;
  /// Share of the body pixels with equally many of every visible part. The rest is drawn by visible area.
  float balanced_share = 0.5F;
  /// Background pixels of a frame for the search for hard negatives. Empty frames give four times as many.
  int hard_pool = 300;
  float hard_share = 0.5F;       ///< most hard negatives, as a multiple of the ordinary background samples
  float held_out_share = 0.02F;  ///< share of frames that no tree learns from, for measuring accuracy
};
void visit_options(const std::string& prefix, SampleOptions& options, OptionVisitor& visitor);

/// The samples of one frame. `TrainingSample::frame` is not set.
struct DrawnSamples {
  std::vector<TrainingSample> samples;      ///< to learn from
  std::vector<TrainingSample> pool;         ///< background to search for hard negatives
  std::vector<std::uint64_t> class_pixels;  ///< readings of each class, the background last
};

/// Appends evenly spaced pixels of each person of a frame whose heading is known, at most 400 of each, and who they
/// are. People of few pixels are left out. `TrainingSample::frame` is `frame`.
void draw_people(const LabelledFrame& labelled, const BodyModel& body, std::uint32_t frame,
                 std::vector<TrainingSample>& samples, std::vector<PersonSamples>& people);

/// Draws pixels with a reading, with replacement. A frame without people gives only its share of background, a frame
/// without background only its share of body. `where` names the frame in errors. Throws Error if images differ in size
/// or the body lacks a label.
DrawnSamples draw_samples(const LabelledFrame& labelled, const BodyModel& body, const SampleOptions& options,
                          Random& random, const std::string& where);

}  // namespace vesalius
