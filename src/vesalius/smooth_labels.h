#pragma once

#include <string>

#include "vesalius/image.h"
#include "vesalius/label_pixels.h"
#include "vesalius/options.h"

namespace vesalius {

struct SmoothOptions {
  int window = 5;                ///< side of the square neighbourhood, pixels, odd; 1 = none
  int depth_gate_mm = 60;        ///< posteriors of neighbours further away than this in depth do not count
  bool mode = false;             ///< labels' mode even where the forest has distributions
  int mode_depth_gate_mm = 300;  ///< the same for the mode, which needs many neighbours more than near ones
};
void visit_options(const std::string& prefix, SmoothOptions& options, OptionVisitor& visitor);

/// The most frequent label among the neighbours within the window, the depth gate and the picture (section 4.2.1).
/// A pixel keeps its label on a tie that includes it; other ties go to the lowest label. Background counts as a label.
/// Pixels without reading become background.
LabelImage mode_filter(const LabelImage& labels, const DepthImage& depth, const SmoothOptions& options);

/// The sum of the posteriors over the same neighbours, rescaled to the range of one pixel's sums (rounded down), so
/// that choose_labels reads both alike.
Posteriors mean_filter(const Posteriors& posteriors, const DepthImage& depth, const SmoothOptions& options);
/// The same into `out`, whose memory is used again; not `posteriors` itself.
void mean_filter(const Posteriors& posteriors, const DepthImage& depth, const SmoothOptions& options, Posteriors& out);

}  // namespace vesalius
