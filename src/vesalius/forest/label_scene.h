#pragma once

#include <memory>

#include "vesalius/base/frame.h"
#include "vesalius/base/stage_times.h"
#include "vesalius/forest/label_pixels.h"
#include "vesalius/forest/smooth_labels.h"
#include "vesalius/planes/find_planes.h"

namespace vesalius {

struct SceneLabelOptions {
  LabelOptions label;
  SmoothOptions smooth;
  PlaneOptions plane;
};

/// What the pixels of one frame are likely to be. Its pictures have the frame's size.
struct SceneLabels {
  Mask flat;              ///< 1 on floor, walls and other large flat surfaces, which are nobody
  DepthImage shown;       ///< depth that the labeller was shown, where that is not the frame's; else empty
  Posteriors raw;         ///< as the labeller gave them
  Posteriors smooth;      ///< the same smoothed; means nothing where labels are smoothed instead
  bool smoothed = false;  ///< whether `smooth` counts

  const Posteriors& posteriors() const { return smoothed ? smooth : raw; }
};

/// Labels scenes, and people in them (section 4), and is alone in knowing that labellers differ:
/// - One without a background class takes walls and floor for bodies. It is shown scenes without their flat surfaces,
/// and
///   a person alone. One with a background class is shown all of a scene, once, while the surfaces are looked for; of a
///   person's pixels it is known that none is background.
/// - Posteriors are smoothed by their mean; where they are but a vote of each tree, labels by their mode.
/// Safe to use from several threads at once.
class SceneLabeller {
 public:
  SceneLabeller(std::shared_ptr<const PixelLabeller> labeller, SceneLabelOptions options);

  const BodyModel& body() const { return labeller_->body(); }

  /// Labels a whole frame. Uses the memory of `used` again, whatever it holds. Tells `clock` when planes, posteriors
  /// and smoothing are done.
  SceneLabels label_scene(const Frame& frame, StageClock& clock, SceneLabels used = {}) const;

  /// Returns the likeliest label of each pixel, kBackground on flat surfaces of labellers without a background class.
  /// The background's posterior counts `background_weight` times.
  LabelImage choose(const SceneLabels& scene, const Frame& frame, float background_weight) const;
  /// Returns the same from posteriors that nothing has smoothed, with the options' weight.
  LabelImage choose_raw(const SceneLabels& scene, const Frame& frame) const;

  /// Returns the likeliest part of each pixel of a person, kBackground elsewhere (but for a rim where labels are
  /// smoothed). `person` is non-zero on the person's pixels, and `box` the smallest around them.
  LabelImage label_person(const SceneLabels& scene, const Frame& frame, const Mask& person, const Box& box) const;

 private:
  LabelImage choose(const Posteriors& posteriors, const DepthImage& depth, float background_weight,
                    const Mask* prior = nullptr, const Box* box = nullptr) const;
  LabelImage label_alone(const Frame& frame, const Mask& person, const Box& box) const;

  std::shared_ptr<const PixelLabeller> labeller_;
  SceneLabelOptions options_;
  bool by_mode_;
};

}  // namespace vesalius
