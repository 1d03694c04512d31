#pragma once

#include <memory>
#include <vector>

#include "vesalius/base/frame.h"
#include "vesalius/base/stage_times.h"
#include "vesalius/forest/label_pixels.h"
#include "vesalius/forest/person_labels.h"
#include "vesalius/forest/smooth_labels.h"
#include "vesalius/planes/find_planes.h"

namespace vesalius {

struct SceneLabelOptions {
  LabelOptions label;
  SmoothOptions smooth;
  PlaneOptions plane;
};

/// The class probabilities of one frame's pixels. All pictures have the frame's size.
struct SceneLabels {
  std::vector<Plane> planes;  ///< floor, walls and other large flat surfaces, largest first
  Mask flat;                  ///< 1 on floor, walls and other large flat surfaces, which are no person
  DepthImage shown;           ///< depth that the labeller was shown; empty if it is the frame's
  Posteriors raw;             ///< posteriors of the labeller
  Posteriors smooth;          ///< smoothed posteriors; undefined if labels are smoothed instead
  Posteriors corrected;  ///< `smooth`, corrected by what is around each pixel; undefined if the forest knows no context
  bool smoothed = false;    ///< whether `smooth` is defined
  bool in_context = false;  ///< whether `corrected` is defined

  /// Returns what the forest says of each pixel by itself. People are judged by it: rendered surroundings are surer
  /// than real ones (decision 37).
  const Posteriors& alone() const { return smoothed ? smooth : raw; }
  /// Returns the same with the context of bodies, if there is one. Labels follow from it.
  const Posteriors& posteriors() const { return in_context ? corrected : alone(); }
};

/// Returns the mean over the pixels of `inside` of the likeliest part's share of all parts, 0-1. Pixels without a
/// reading or surely background do not count. Both have the same size.
float mean_certainty(const Posteriors& posteriors, const Mask& inside, int parts);

/// Labels scenes and the people in them (section 4). It is the only class that knows how labellers differ. A labeller
/// without a background class takes walls and floor for bodies, so it is shown scenes without their flat surfaces, and
/// a person alone. One with a background class is shown the whole scene once, while the surfaces are searched for; a
/// person's pixels are then known not to be background. Posteriors are smoothed by their mean; if they are only one
/// vote for each tree, labels are smoothed by their mode instead. Where the forest knows a context of bodies, the
/// smoothed posteriors are corrected by it (body_context.h). It may be used from several threads at once.
class SceneLabeller {
 public:
  /// Throws Error for a labeller whose context asks for features that are not known.
  SceneLabeller(std::shared_ptr<const PixelLabeller> labeller, SceneLabelOptions options);

  const BodyModel& body() const { return labeller_->body(); }

  /// Labels a whole frame and reuses the memory of `used`. Tells `clock` when planes, posteriors, smoothing and context
  /// are done.
  SceneLabels label_scene(const Frame& frame, StageClock& clock, SceneLabels used = {}) const;

  /// Returns the likeliest label of each pixel, kBackground on flat surfaces of labellers without a background class.
  /// The background's posterior counts `background_weight` times.
  LabelImage choose(const SceneLabels& scene, const Frame& frame, float background_weight) const;
  /// Returns the same from unsmoothed posteriors, with the options' weight.
  LabelImage choose_raw(const SceneLabels& scene, const Frame& frame) const;

  /// Returns the likeliest part of each pixel of a person and kBackground elsewhere, except for a rim if labels are
  /// smoothed. `person` is non-zero on the person's pixels, and `box` is the smallest box around them.
  /// Where leaves have headings, parts are those of the heading that all of the person's pixels tell.
  PersonLabels label_person(const SceneLabels& scene, const Frame& frame, const Mask& person, const Box& box) const;

 private:
  LabelImage choose(const Posteriors& posteriors, const DepthImage& depth, float background_weight,
                    const Mask* prior = nullptr, const Box* box = nullptr) const;
  PersonLabels label_turned(const SceneLabels& scene, const Frame& frame, const Mask& person, const Box& box) const;
  PersonLabels label_alone(const Frame& frame, const Mask& person, const Box& box) const;

  std::shared_ptr<const PixelLabeller> labeller_;
  SceneLabelOptions options_;
  std::vector<std::uint8_t> sides_;
  bool by_mode_;
  BoostedTrees context_;
};

}  // namespace vesalius
