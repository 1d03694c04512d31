#pragma once

#include "vesalius/base/frame.h"
#include "vesalius/base/image.h"
#include "vesalius/forest/posteriors.h"

namespace vesalius {

struct SmoothOptions;

/// Gives every pixel of a frame its posteriors: those of the parts of a body and, last, that of the background. A model
/// (vesalius/model.h) has one; tests and experiments provide others (the truth, a network).
///
/// All member functions are called from several threads at once, also for different frames: a labeller keeps nothing
/// between calls that could change a result. It may run work in parallel itself (base/parallel.h).
class Labeller {
 public:
  virtual ~Labeller() = default;

  /// Writes the posteriors of all pixels to `out` and reuses its memory. It sees the whole frame: depth, colour if
  /// there is some, the camera, and the way up if it was measured. What Posteriors calls optional is left empty by
  /// those who do not know it. If the background has a probability of at least `gate` all around a pixel, the pixel may
  /// get the posteriors of a neighbour of similar depth and be marked as settled. A labeller that looks at such pixels
  /// gives other posteriors there, which are equally valid. With a gate above 1 every pixel is looked at, and all
  /// devices give the same bits.
  virtual void label_into(const Frame& frame, float gate, Posteriors& out) const = 0;

  /// Writes the posteriors as label_into does, and to `smooth` the smoothed ones. Returns false and does nothing where
  /// that is mean_filter of the former (smooth_labels.h) and no quicker than one after the other.
  virtual bool label_and_smooth_into(const Frame& /*frame*/, float /*gate*/, const SmoothOptions& /*options*/,
                                     Posteriors& /*out*/, Posteriors& /*smooth*/) const {
    return false;
  }

  /// Looks again at the pixels of one person, those where `person` is not 0, all inside `box`: writes their smoothed
  /// posteriors to `out`, a picture of the box's size. Returns false and does nothing where that would tell no more
  /// than the posteriors of the whole frame do.
  virtual bool label_person_into(const Frame& /*frame*/, const Mask& /*person*/, const Box& /*box*/,
                                 const SmoothOptions& /*options*/, Posteriors& /*out*/) const {
    return false;
  }

  /// Returns the posteriors of all pixels, each looked at.
  Posteriors label(const Frame& frame) const {
    Posteriors out;
    label_into(frame, 2.F, out);
    return out;
  }
};

}  // namespace vesalius
