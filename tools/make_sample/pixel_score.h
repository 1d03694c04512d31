#pragma once

#include <vector>

#include "vesalius/forest.h"
#include "vesalius/frame.h"

namespace vesalius {

/// How well single pixels are labelled, without smoothing.
struct PixelScore {
  double part_recall = 0.0;            ///< mean over the parts of the share of their pixels labelled right, background
                                       ///< left out of the choice
  double body_recall = 0.0;            ///< share of the body's pixels given any part
  double body_precision = 0.0;         ///< share of the pixels given a part that are body
  std::vector<double> recall_by_part;  ///< NaN for parts never in view
};

PixelScore score_pixels(const Forest& forest, const std::vector<LabelledFrame>& frames);

}  // namespace vesalius
