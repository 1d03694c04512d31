#include "vesalius/forest/smooth_window.h"

#include <algorithm>
#include <cmath>

namespace vesalius {

int excess_bits(int whole, const SmoothWindow& window) {
  int bits = 0;
  while ((whole >> bits) * window.most() > 65535) ++bits;
  return bits;
}

SmoothOptions spaced(SmoothOptions options, const Camera& camera) {
  constexpr float kSpacings = 140.F;  // number of spacings in the focal length
  if (options.spacing == 0) options.spacing = std::max(1, int(std::lround(camera.fx / kSpacings)));
  return options;
}

int window_side(const SmoothOptions& options) { return options.window == 0 ? 5 : options.window; }

SmoothWindow smooth_window(const SmoothOptions& options, const Camera& camera) {
  return {window_side(options) / 2, spaced(options, camera).spacing, options.depth_gate_mm};
}

}  // namespace vesalius
