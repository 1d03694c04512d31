#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "train/training_set.h"
#include "vesalius/base/body_model.h"
#include "vesalius/base/frame.h"
#include "vesalius/base/random.h"

namespace vesalius {

/// What one frame gives to a training set; `frame` of the samples is not set.
struct DrawnSamples {
  std::vector<TrainingSample> samples;      ///< to learn from
  std::vector<TrainingSample> pool;         ///< background to search for hard negatives
  std::vector<std::uint64_t> class_pixels;  ///< readings of each class, the background last
};

/// Draws pixels with a reading, with replacement. A frame without people gives its background share only, one without
/// background its body share only. `where` names the frame in errors. Throws Error for images that differ in size and
/// for labels that the body lacks.
DrawnSamples draw_samples(const LabelledFrame& labelled, const BodyModel& body, const SampleOptions& options,
                          Random& random, const std::string& where);

}  // namespace vesalius
