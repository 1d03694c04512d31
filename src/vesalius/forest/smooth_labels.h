#pragma once

#include "vesalius/camera.h"
#include "vesalius/forest/smooth_window.h"
#include "vesalius/image.h"
#include "vesalius/labeller.h"

namespace vesalius {

/// Depth gate of the mode, which needs many neighbours more than near ones.
inline constexpr int kModeDepthGate_mm = 300;

/// Returns for each pixel the most frequent label of the pixels within the window, kModeDepthGate_mm and the
/// picture (section 4.2.1); spacing is ignored. A pixel keeps its label on a tie that includes it; other ties go to the
/// lowest label. Background counts as a label. Pixels without a reading become background.
LabelImage mode_filter(const LabelImage& labels, const DepthImage& depth, const SmoothOptions& options);

/// Returns for each pixel the mean of the posteriors of the neighbours within the window and the depth gate, `spacing`
/// apart. It is rounded down and in the range of one pixel's sums, so that choose_labels reads both alike. Adjacent
/// pixels mostly have the same errors, so the same number of pixels further apart says more. If the sums over a window
/// exceed 16 bits (with the default window: for more than 10 trees), each loses its lowest bits beforehand.
Posteriors mean_filter(const Posteriors& posteriors, const DepthImage& depth, const Camera& camera,
                       const SmoothOptions& options);
/// Writes the same to `out` and reuses its memory. `out` must not be `posteriors`.
void mean_filter(const Posteriors& posteriors, const DepthImage& depth, const Camera& camera,
                 const SmoothOptions& options, Posteriors& out);

}  // namespace vesalius
