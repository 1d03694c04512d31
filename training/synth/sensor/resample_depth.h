#pragma once

#include <cstdint>
#include <string>

#include "vesalius/base/options.h"
#include "vesalius/base/random.h"
#include "vesalius/frame.h"

namespace vesalius::synth {

/// How recorders and datasets change the size of depth pictures: which frames, and how much at most.
struct ResamplingOptions {
  float share = 0.F;           ///< share of frames that had another size once
  float smallest = 0.5F;       ///< smallest size they had, as a share of theirs
  float holes_blended = 0.3F;  ///< share of those in which holes were blended as readings of 0
  friend bool operator==(const ResamplingOptions&, const ResamplingOptions&) = default;
};

void visit_options(const std::string& prefix, ResamplingOptions& options, OptionVisitor& visitor);

/// The change of one frame: to a share of its size and back.
struct Resampling {
  float scale = 1.F;               ///< above 0; 1 changes nothing
  bool interpolated_down = false;  ///< whether readings are blended when the picture gets smaller; else the nearest is
  bool interpolated_up = false;    ///< the same when it gets its size again, which makes ramps of silhouettes
  bool holes_blended = false;      ///< whether a hole counts as a reading of 0, which makes ramps around it
};

/// Draws a size, evenly, and how pictures are interpolated: on the way down, up, or both.
Resampling draw_resampling(const ResamplingOptions& options, Random& random);

/// Changes a depth picture's size and changes it back. `source`, of the same size and if not null, tells for each pixel
/// whose surface was read (sense()); each pixel takes over that of the reading nearest to it.
void apply(const Resampling& resampling, DepthImage& depth, Image<std::uint32_t>* source = nullptr);

}  // namespace vesalius::synth
