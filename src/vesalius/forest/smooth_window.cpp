#include "vesalius/forest/smooth_window.h"

#include <algorithm>
#include <cmath>

namespace vesalius {

int excess_bits(int whole, const SmoothWindow& window) {
  int bits = 0;
  while ((whole >> bits) * window.most() > 65535) ++bits;
  return bits;
}

void visit_options(const std::string& prefix, SmoothOptions& o, OptionVisitor& visitor) {
  visitor.option(
      prefix + "window", o.window,
      {"", 1, 31,
       "Neighbours along a side of the smoothing window, 1 = none; an even number counts as the next odd one."});
  visitor.option(prefix + "spacing", o.spacing,
                 {"px", 0, 31, "From one neighbour to the next, 0: about 1/140 of the focal length."});
  visitor.option(prefix + "depth-gate", o.depth_gate_mm,
                 {"mm", 0, 10000, "Neighbours further away than this in depth do not count."});
}

SmoothOptions spaced(SmoothOptions options, const Camera& camera) {
  constexpr float kSpacings = 140.F;  // number of spacings in the focal length
  if (options.spacing == 0) options.spacing = std::max(1, int(std::lround(camera.fx / kSpacings)));
  return options;
}

SmoothWindow smooth_window(const SmoothOptions& options, const Camera& camera) {
  return {options.window / 2, spaced(options, camera).spacing, options.depth_gate_mm};
}

}  // namespace vesalius
