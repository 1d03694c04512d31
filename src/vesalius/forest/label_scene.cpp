#include "vesalius/forest/label_scene.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "vesalius/base/parallel.h"
#include "vesalius/base/pixel_grid.h"
#include "vesalius/forest/body_context.h"
#include "vesalius/forest/facing.h"
#include "vesalius/forest/leaf_logits.h"

namespace vesalius {
namespace {

DepthImage without(const DepthImage& depth, const Mask& mask) {
  DepthImage out = depth;
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (mask[i] != 0) out[i] = 0;
  }
  return out;
}

/// Returns the depth inside the box, with no reading outside the mask.
DepthImage keep_only(const DepthImage& depth, const Mask& mask, const Box& box) {
  DepthImage out = crop(depth, box);
  for (int v = 0; v < box.height; ++v) {
    for (int u = 0; u < box.width; ++u) {
      if (mask(box.u + u, box.v + v) == 0) out(u, v) = 0;
    }
  }
  return out;
}

/// Returns a picture of the frame's size with `part` at its place and background around.
LabelImage uncropped(const LabelImage& part, const Box& box, const Camera& camera) {
  LabelImage out(camera.width, camera.height, kBackground);
  for (int v = 0; v < box.height; ++v) std::copy_n(part.row(v), box.width, out.row(box.v + v) + box.u);
  return out;
}

/// Returns the box with so many more pixels on all sides, as far as the picture goes.
Box grown(const Box& box, int by, const Camera& camera) {
  const int left = std::max(0, box.u - by), top = std::max(0, box.v - by);
  const int right = std::min(camera.width, box.u + box.width + by);
  const int bottom = std::min(camera.height, box.v + box.height + by);
  return {left, top, right - left, bottom - top};
}

}  // namespace

float mean_certainty(const Posteriors& posteriors, const Mask& inside, int parts) {
  double sum = 0.0;
  long pixels = 0;
  for (int v = 0; v < posteriors.height; ++v) {
    for (int u = 0; u < posteriors.width; ++u) {
      if (inside(u, v) == 0) continue;
      const std::uint16_t* sums = posteriors.at(u, v);
      const double body = std::accumulate(sums, sums + parts, 0.0);
      if (body == 0.0) continue;
      sum += *std::max_element(sums, sums + parts) / body;
      ++pixels;
    }
  }
  return pixels > 0 ? float(sum / double(pixels)) : 0.F;
}

SceneLabeller::SceneLabeller(std::shared_ptr<const PixelLabeller> labeller, SceneLabelOptions options)
    : labeller_(std::move(labeller)),
      options_(options),
      sides_(LogitLayout(labeller_->body(), labeller_->has_background(), 0).side),
      by_mode_(options.smooth.mode || !labeller_->has_distributions()) {
  if (labeller_->context().empty()) return;
  context_ = in_order(labeller_->context(), BodySurroundings::feature_names(body()), "context of bodies");
}

SceneLabels SceneLabeller::label_scene(const Frame& frame, StageClock& clock, SceneLabels used) const {
  SceneLabels scene = std::move(used);
  const auto find_planes = [&] {
    FlatSurfaces surfaces = find_flat_surfaces(frame.depth, frame.camera, options_.plane);
    scene.planes = std::move(surfaces.planes);
    scene.flat = std::move(surfaces.pixels);
  };
  scene.smoothed = !by_mode_;
  bool is_smooth = false;
  const auto label = [&](const DepthImage& depth) {
    const float gate = options_.label.gate;
    is_smooth = scene.smoothed &&
                labeller_->label_and_smooth_into(depth, frame.camera, gate, options_.smooth, scene.raw, scene.smooth);
    if (!is_smooth) labeller_->label_into(depth, frame.camera, gate, scene.raw);
  };
  if (labeller_->has_background()) {
    scene.shown = {};
    std::array<double, 2> took_ms{};
    parallel_for(2, [&](int i) { took_ms[i] = elapsed_ms([&] { i == 0 ? find_planes() : label(frame.depth); }); });
    clock.lap({Stage::planes, Stage::label}, took_ms);
  } else {
    find_planes();
    clock.lap(Stage::planes);
    scene.shown = without(frame.depth, scene.flat);
    label(scene.shown);
    clock.lap(Stage::label);
  }
  if (scene.smoothed && !is_smooth) {
    const DepthImage& depth = scene.shown.empty() ? frame.depth : scene.shown;
    mean_filter(scene.raw, depth, frame.camera, options_.smooth, scene.smooth);
  }
  clock.lap(Stage::smooth);
  scene.in_context = scene.smoothed && !context_.empty();
  if (scene.in_context) {
    correct_bodies(context_, frame.depth, frame.camera, body(), scene.smooth, scene.corrected);
  }
  clock.lap(Stage::context);
  return scene;
}

LabelImage SceneLabeller::choose(const Posteriors& posteriors, const DepthImage& depth, float background_weight,
                                 const Mask* prior, const Box* box) const {
  LabelOptions options = options_.label;
  options.background_weight = background_weight;
  const LabelChoice choice{body().part_count(), labeller_->has_background(), prior, box};
  LabelImage labels = choose_labels(posteriors, depth, choice, options);
  return by_mode_ ? mode_filter(labels, depth, options_.smooth) : labels;
}

LabelImage SceneLabeller::choose(const SceneLabels& scene, const Frame& frame, float background_weight) const {
  return choose(scene.posteriors(), scene.shown.empty() ? frame.depth : scene.shown, background_weight);
}

LabelImage SceneLabeller::choose_raw(const SceneLabels& scene, const Frame& frame) const {
  const LabelChoice choice{body().part_count(), labeller_->has_background()};
  return choose_labels(scene.raw, scene.shown.empty() ? frame.depth : scene.shown, choice, options_.label);
}

PersonLabels SceneLabeller::label_person(const SceneLabels& scene, const Frame& frame, const Mask& person,
                                         const Box& box) const {
  if (box.width == 0) return {LabelImage(frame.camera.width, frame.camera.height, kBackground), {}, 0.F};
  if (!labeller_->has_background()) return label_alone(frame, person, box);
  if (!labeller_->facing_model().empty() && scene.smoothed) return label_turned(scene, frame, person, box);
  const Posteriors& posteriors = scene.posteriors();
  PersonLabels result{choose(posteriors, frame.depth, options_.label.background_weight, &person, &box),
                      {},
                      mean_certainty(posteriors, person, body().part_count())};
  result.points = sample_points(frame.depth, frame.camera, result.labels, box, posteriors,
                                {0, 0, frame.camera.width, frame.camera.height}, body().part_count());
  return result;
}

PersonLabels SceneLabeller::label_turned(const SceneLabels& scene, const Frame& frame, const Mask& person,
                                         const Box& box) const {
  PersonLabels result;
  result.facing = facing(labeller_->facing_model(), facing_features(scene.raw, body().part_count(), person, box));
  const Box around =
      grown(box, options_.smooth.window / 2 * spaced(options_.smooth, frame.camera).spacing, frame.camera);
  const DepthImage depth = crop(frame.depth, around);
  Posteriors turned, smooth;
  turn_posteriors(scene.raw, sides_, result.facing, around, turned);
  mean_filter(turned, depth, frame.camera, options_.smooth, smooth);
  const Mask inside = crop(person, around);
  const Box within{box.u - around.u, box.v - around.v, box.width, box.height};
  result.labels =
      uncropped(choose(smooth, depth, options_.label.background_weight, &inside, &within), around, frame.camera);
  result.certain = mean_certainty(smooth, inside, body().part_count());
  result.points = sample_points(frame.depth, frame.camera, result.labels, box, smooth, around, body().part_count());
  return result;
}

PersonLabels SceneLabeller::label_alone(const Frame& frame, const Mask& person, const Box& box) const {
  const DepthImage alone = keep_only(frame.depth, person, box);
  const Camera camera = cropped(frame.camera, box);
  Posteriors posteriors;
  labeller_->label_into(alone, camera, options_.label.gate, posteriors);
  if (!by_mode_) posteriors = mean_filter(posteriors, alone, camera, options_.smooth);
  PersonLabels result{uncropped(choose(posteriors, alone, options_.label.background_weight), box, frame.camera),
                      {},
                      mean_certainty(posteriors, crop(person, box), body().part_count())};
  result.points = sample_points(frame.depth, frame.camera, result.labels, box, posteriors, box, body().part_count());
  return result;
}

}  // namespace vesalius
