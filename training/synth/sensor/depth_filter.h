#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "vesalius/base/options.h"
#include "vesalius/base/random.h"
#include "vesalius/frame.h"

namespace vesalius::synth {

/// What drivers do to depth after it was measured, as RealSense's post-processing and the smoothing of OpenNI: which
/// frames get it, and how much at most.
struct DepthFilterOptions {
  float share = 0.F;         ///< share of frames that are filtered; the others stay as they are
  float fill_share = 0.8F;   ///< share of those whose holes are filled
  int fill_px = 16;          ///< how far from a reading holes are filled
  float smoothing = 0.85F;   ///< greatest weight of the neighbour in the edge-preserving filter
  float step_per_m = 0.03F;  ///< steps of the inverse depth from here on are edges, 1/metres
  float blur_px = 3.F;       ///< greatest reach of the blur that bridges edges
  float far_blur_px = 8.F;   ///< greatest reach of the blur at 5 m; it begins at 1.5 m
  friend bool operator==(const DepthFilterOptions&, const DepthFilterOptions&) = default;
};

void visit_options(const std::string& prefix, DepthFilterOptions& options, OptionVisitor& visitor);

/// From which neighbour holes are filled, in the order of the picture's rows and columns: from the left one, or from
/// the farthest or the nearest of those above, below and to the left.
enum class HoleFill : std::uint8_t { left, farthest, nearest };

/// The filter of one frame.
struct DepthFilter {
  std::optional<HoleFill> fill = std::nullopt;  ///< empty leaves holes
  int fill_px = 16;                             ///< how far from a reading holes are filled
  float smoothing = 0.F;                        ///< weight of the neighbour, 0 to below 1; 0 smooths nothing
  int passes = 0;                               ///< each goes over rows and columns in both directions
  float step_per_m = 0.03F;
  float blur_px = 0.F, far_blur_px = 0.F;
};

/// Draws each amount evenly from nothing to the greatest; smoothing from half of it.
DepthFilter draw_filter(const DepthFilterOptions& options, Random& random);

/// Fills, smooths and then blurs a depth picture. Columns and rows at its borders without any reading, and other holes
/// that are not filled, stay and do not count. `source`, of the
/// size of the depth and if not null, tells for each pixel whose surface was read (sense()); filled pixels take over
/// that of their neighbour. The other pixels keep theirs although their depth becomes a mixture.
void apply(const DepthFilter& filter, DepthImage& depth, Image<std::uint32_t>* source = nullptr);

}  // namespace vesalius::synth
