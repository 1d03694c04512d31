#pragma once

#include <vector>

#include "synth/body/poser.h"
#include "synth/body/simplify.h"

namespace vesalius::synth {

/// Coarser surfaces of one body, worked out once. Their vertices are some of the body's own, so any pose of it serves.
class BodyDetail {
 public:
  explicit BodyDetail(const Poser& poser);

  /// Returns the coarsest surface that strays at most so far from the full one; null where only the full one does.
  const CoarseSurface* within(float error_m) const;

 private:
  std::vector<CoarseSurface> levels_;  ///< coarser and coarser
};

}  // namespace vesalius::synth
