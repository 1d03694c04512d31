#pragma once

#include <cstdint>
#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/forest.h"
#include "vesalius/frame.h"
#include "vesalius/tree_walk.h"

namespace vesalius {

/// One pixel to learn from.
struct TrainingPixel {
  std::int32_t frame = 0;  ///< index of its frame
  std::int16_t u = 0, v = 0;
  OffsetScale scale;       ///< of the offsets at its depth
  std::uint8_t label = 0;  ///< class of the forest: body part, or part_count for the background
};

/// How a tree's pixels are drawn.
struct SampleOptions {
  int pixels_per_frame = 400;
  float background_share = 0.5F;  ///< of a frame's pixels
  float near_share = 0.4F;        ///< of the background pixels: within `near_px` of a person
  int near_px = 40;
  float balanced_share = 0.5F;  ///< of the body pixels: every part in view equally often, the rest by visible area
};

/// Pixels with a reading, drawn with replacement. Frames without people give their background share only, frames
/// without background their body share only. Ordered by frame; depends on (seed, tree) and the frames alone.
/// Throws Error for a frame whose images differ in size or whose labels the body lacks.
std::vector<TrainingPixel> sample_pixels(const std::vector<LabelledFrame>& frames, const BodyModel& body,
                                         const FeatureConvention& convention, const SampleOptions& options,
                                         std::uint64_t seed, std::uint64_t tree);

}  // namespace vesalius
