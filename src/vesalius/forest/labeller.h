#pragma once

#include "vesalius/base/body_model.h"
#include "vesalius/base/camera.h"
#include "vesalius/base/image.h"
#include "vesalius/forest/boosted_trees.h"
#include "vesalius/forest/forest.h"
#include "vesalius/forest/posteriors.h"

namespace vesalius {

struct SmoothOptions;

/// Gives every pixel of a depth image its part posteriors. make_labeller (make_labeller.h) returns the shipped ones;
/// tests and experiments provide others (the truth, a network).
///
/// All member functions are called from several threads at once, also for different pictures: a labeller keeps nothing
/// between calls that could change a result. It may run work in parallel itself (base/parallel.h).
class PixelLabeller {
 public:
  virtual ~PixelLabeller() = default;

  /// Writes the posteriors of all pixels to `out` and reuses its memory. If the background has a probability of at
  /// least `gate` all around a pixel, the pixel may get the posteriors of a neighbour of similar depth and be marked as
  /// settled. A labeller that looks at such pixels gives other posteriors there, which are equally valid. With a gate
  /// above 1 every pixel is looked at, and all devices give the same bits for one forest.
  virtual void label_into(const DepthImage& depth, const Camera& camera, float gate, Posteriors& out) const = 0;

  /// Writes the posteriors as label_into does, and to `smooth` what mean_filter (smooth_labels.h) makes of them.
  /// Returns false and does nothing where the labeller has no quicker way than one after the other.
  virtual bool label_and_smooth_into(const DepthImage& /*depth*/, const Camera& /*camera*/, float /*gate*/,
                                     const SmoothOptions& /*options*/, Posteriors& /*out*/,
                                     Posteriors& /*smooth*/) const {
    return false;
  }

  /// Returns the posteriors of all pixels, each looked at.
  Posteriors label(const DepthImage& depth, const Camera& camera) const {
    Posteriors out;
    label_into(depth, camera, 2.F, out);
    return out;
  }

  virtual const BodyModel& body() const = 0;
  /// Returns whether the last class is the background.
  virtual bool has_background() const = 0;
  /// Returns whether posteriors are more than one vote for each tree.
  virtual bool has_distributions() const = 0;
  /// Returns how a person's heading follows from the posteriors' headings, if it has any.
  virtual const FacingModel& facing_model() const {
    static const FacingModel kNone;
    return kNone;
  }
  /// Returns how what is around a pixel tells whether it is a body (body_context.h), if the forest tells.
  virtual const BoostedTrees& context() const {
    static const BoostedTrees kNone;
    return kNone;
  }
  /// Returns which proposals are people, if the forest tells.
  virtual const BoostedTrees& judge() const {
    static const BoostedTrees kNone;
    return kNone;
  }
};

}  // namespace vesalius
