#pragma once

#include <cstdint>
#include <vector>

#include "vesalius/forest/label_pixels.h"
#include "vesalius/forest/person_points.h"
#include "vesalius/forest/smooth_labels.h"
#include "vesalius/frame.h"
#include "vesalius/model.h"
#include "vesalius/planes/find_planes.h"
#include "vesalius/stage_times.h"

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
  Posteriors raw;             ///< posteriors of the labeller
  /// Smoothed posteriors: what the labeller says of each pixel by itself. People are judged by it: rendered
  /// surroundings are surer than real ones (decision 37).
  Posteriors smooth;
  Posteriors corrected;  ///< `smooth`, corrected by what is around each pixel; undefined if the model knows no context
  bool in_context = false;  ///< whether `corrected` is defined

  /// Returns the smoothed posteriors with the context of bodies, if there is one. Labels follow from it.
  const Posteriors& posteriors() const { return in_context ? corrected : smooth; }
};

/// Returns the mean over the pixels of `inside` of the likeliest part's share of all parts, 0-1. Pixels without a
/// reading or surely background do not count. Both have the same size.
float mean_certainty(const Posteriors& posteriors, const Mask& inside, int parts);

/// Labels scenes and the people in them (section 4). The labeller is shown a scene once, while its flat surfaces are
/// searched for; a person's pixels are then known not to be background. Where the model knows a context of bodies, the
/// smoothed posteriors are corrected by it (body_context.h). It may be used from several threads at once.
class SceneLabeller {
 public:
  /// `model` has a labeller (on_device). Throws Error for a context that asks for features that are not known.
  SceneLabeller(Model model, SceneLabelOptions options);

  const BodyModel& body() const { return model_.body; }

  /// Labels a whole frame and reuses the memory of `used`. Tells `clock` when planes, posteriors, smoothing and context
  /// are done. Planes that are `known` are not searched for.
  SceneLabels label_scene(const Frame& frame, StageClock& clock, SceneLabels used = {},
                          const std::vector<Plane>* known = nullptr) const;

  /// Returns the likeliest label of each pixel. The background's posterior counts `background_weight` times.
  LabelImage choose(const SceneLabels& scene, const Frame& frame, float background_weight) const;
  /// Returns the same from unsmoothed posteriors, with the options' weight.
  LabelImage choose_raw(const SceneLabels& scene, const Frame& frame) const;

  /// Returns the likeliest part of each pixel of a person and kBackground elsewhere. `person` is non-zero on the
  /// person's pixels, and `box` is the smallest box around them. Where the labeller looks again at people, it does so
  /// here. Where it knows headings, parts are those of the heading that all of the person's pixels tell.
  PersonLabels label_person(const SceneLabels& scene, const Frame& frame, const Mask& person, const Box& box) const;

 private:
  PersonLabels label_with(const Posteriors& posteriors, const Box& of, const Frame& frame, const Mask& person,
                          const Box& box) const;

  Model model_;
  SceneLabelOptions options_;
  std::vector<std::uint8_t> sides_;
};

}  // namespace vesalius
