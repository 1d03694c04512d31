#include "eval/label_scene.h"

namespace vesalius {

SceneLabels label_scene(const PixelLabeller& labeller, const DetectOptions& options, const Frame& frame,
                        const Mask* body) {
  const bool by_mode = options.smooth.mode || !labeller.has_distributions();
  Posteriors posteriors;
  labeller.label_into(frame.depth, frame.camera, options.label, posteriors);
  if (!by_mode) posteriors = mean_filter(posteriors, frame.depth, options.smooth);
  const auto choose = [&](const Mask* prior) {
    const LabelChoice choice{labeller.body().part_count(), labeller.has_background(), prior};
    LabelImage labels = choose_labels(posteriors, frame.depth, choice, options.label);
    return by_mode ? mode_filter(labels, frame.depth, options.smooth) : labels;
  };
  SceneLabels result;
  result.labels = choose(nullptr);
  if (body != nullptr) result.inside = choose(body);
  return result;
}

}  // namespace vesalius
