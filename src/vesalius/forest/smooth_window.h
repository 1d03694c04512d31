#pragma once

#include <string>

#include "vesalius/camera.h"
#include "vesalius/people_options.h"

namespace vesalius {

/// Returns the options with a spacing. If it is 0, it becomes 1/140 of the focal length in pixels, rounded, at least 1,
/// which is a step of 18 mm at 2.5 m.
SmoothOptions spaced(SmoothOptions options, const Camera& camera);

/// The neighbours that smoothing uses: those in a square around the pixel, including itself, whose depth differs from
/// its depth by at most `gate_mm`.
struct SmoothWindow {
  int each_way = 0;  ///< neighbours to each side, upwards and downwards
  int spacing = 1;   ///< pixels from one neighbour to the next
  int gate_mm = 0;

  int reach() const { return each_way * spacing; }
  int most() const { return (2 * each_way + 1) * (2 * each_way + 1); }
};

/// Returns the neighbours along a side of the window: those of the options, or 5.
int window_side(const SmoothOptions& options);

/// Returns the window of mean_filter.
SmoothWindow smooth_window(const SmoothOptions& options, const Camera& camera);

/// Returns how many bits probabilities (Posteriors::whole) must lose so that the sum over a window takes at most 16.
int excess_bits(int whole, const SmoothWindow& window);

}  // namespace vesalius
