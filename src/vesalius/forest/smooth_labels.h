#pragma once

#include <string>

#include "vesalius/base/camera.h"
#include "vesalius/base/image.h"
#include "vesalius/base/options.h"
#include "vesalius/forest/label_pixels.h"

namespace vesalius {

struct SmoothOptions {
  int window = 5;                ///< neighbours along a side of the square; even: as the next odd number; 1 = none
  int spacing = 0;               ///< pixels from one neighbour to the next, of posteriors; 0: see `spaced`
  int depth_gate_mm = 60;        ///< posteriors of neighbours further away than this in depth do not count
  bool mode = false;             ///< labels' mode even where the forest has distributions
  int mode_depth_gate_mm = 300;  ///< the same for the mode, which needs many neighbours more than near ones
};
void visit_options(const std::string& prefix, SmoothOptions& options, OptionVisitor& visitor);

/// The options with a spacing: where it is 0, the pixels in 1/140 of the focal length, rounded, at least 1. That is a
/// step of 18 mm at 2.5 m.
SmoothOptions spaced(SmoothOptions options, const Camera& camera);

/// The most frequent label among the neighbours, next to each other, within the window, the depth gate and the picture
/// (section 4.2.1). A pixel keeps its label on a tie that includes it; other ties go to the lowest label. Background
/// counts as a label. Pixels without reading become background.
LabelImage mode_filter(const LabelImage& labels, const DepthImage& depth, const SmoothOptions& options);

/// The sum of the posteriors over such neighbours `spacing` apart, rescaled to the range of one pixel's sums
/// (rounded down), so that choose_labels reads both alike. Pixels next to each other mostly err alike: as many further
/// apart say more.
Posteriors mean_filter(const Posteriors& posteriors, const DepthImage& depth, const Camera& camera,
                       const SmoothOptions& options);
/// The same into `out`, whose memory is used again; not `posteriors` itself.
void mean_filter(const Posteriors& posteriors, const DepthImage& depth, const Camera& camera,
                 const SmoothOptions& options, Posteriors& out);

}  // namespace vesalius
