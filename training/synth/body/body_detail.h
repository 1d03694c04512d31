#pragma once

#include <vector>

#include "synth/body/poser.h"
#include "synth/body/simplify.h"

namespace vesalius::synth {

/// Coarser surfaces of one body, computed once. Their vertices are a subset of the body's own, so they fit any pose of
/// it.
class BodyDetail {
 public:
  explicit BodyDetail(const Poser& poser);

  /// Returns the coarsest surface that differs from the full one by at most `error_m`, or null if none does.
  const CoarseSurface* within(float error_m) const;

 private:
  std::vector<CoarseSurface> levels_;  ///< each one coarser than the previous
};

}  // namespace vesalius::synth
