#include "eval/label_scene.h"

namespace vesalius {
namespace {

SceneLabels label_everywhere(const PixelLabeller& labeller, const DetectOptions& options, const DepthImage& depth,
                             const Camera& camera, const Mask* body) {
  const bool by_mode = options.smooth.mode || !labeller.has_distributions();
  Posteriors posteriors;
  labeller.label_into(depth, camera, options.label, posteriors);
  if (!by_mode) posteriors = mean_filter(posteriors, depth, camera, options.smooth);
  const auto choose = [&](const Mask* prior) {
    const LabelChoice choice{labeller.body().part_count(), labeller.has_background(), prior};
    LabelImage labels = choose_labels(posteriors, depth, choice, options.label);
    return by_mode ? mode_filter(labels, depth, options.smooth) : labels;
  };
  SceneLabels result;
  result.labels = choose(nullptr);
  if (body != nullptr) result.inside = choose(body);
  return result;
}

}  // namespace

SceneLabels label_scene(const PixelLabeller& labeller, const DetectOptions& options, const Frame& frame,
                        const Mask* body) {
  const int step = grid_step(frame.camera, options.grid);
  if (step == 1) return label_everywhere(labeller, options, frame.depth, frame.camera, body);
  const Mask coarse_body = body != nullptr ? every_nth(*body, step) : Mask{};
  const Frame coarse = every_nth(frame, step);
  SceneLabels result =
      label_everywhere(labeller, options, coarse.depth, coarse.camera, body != nullptr ? &coarse_body : nullptr);
  const GridGuide guide(frame.depth, step);
  result.labels = guide.enlarge(result.labels, kBackground);
  if (body != nullptr) result.inside = guide.enlarge(result.inside, kBackground);
  return result;
}

}  // namespace vesalius
