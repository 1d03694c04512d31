#include "vesalius/label_scene.h"

#include <algorithm>
#include <array>
#include <utility>

#include "vesalius/base/pixel_grid.h"
#include "vesalius/forest/body_context.h"
#include "vesalius/forest/facing.h"
#include "vesalius/forest/leaf_logits.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

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
      int body = 0, most = 0;  // whole numbers, which fill vectors
      for (int part = 0; part < parts; ++part) {
        body += sums[part];
        most = std::max<int>(most, sums[part]);
      }
      if (body == 0) continue;
      sum += most / double(body);
      ++pixels;
    }
  }
  return pixels > 0 ? float(sum / double(pixels)) : 0.F;
}

SceneLabeller::SceneLabeller(Model model, SceneLabelOptions options)
    : model_(std::move(model)), options_(options), sides_(LogitLayout(model_.body, true, 0).side) {
  if (options_.smooth.window == 0) options_.smooth.window = model_.labeller->smoothing_window();
  if (model_.context.empty()) return;
  model_.context = in_order(std::move(model_.context), BodySurroundings::feature_names(body()), "context of bodies");
}

SceneLabels SceneLabeller::label_scene(const Frame& frame, StageClock& clock, SceneLabels used,
                                       const std::vector<Plane>* known) const {
  SceneLabels scene = std::move(used);
  const auto find_planes = [&] {
    if (known != nullptr) {
      scene.planes = *known;
      scene.flat = pixels_on(*known, frame.depth, frame.camera, options_.plane);
      return;
    }
    FlatSurfaces surfaces = find_flat_surfaces(frame.depth, frame.camera, options_.plane);
    scene.planes = std::move(surfaces.planes);
    scene.flat = std::move(surfaces.pixels);
  };
  bool is_smooth = false;
  const auto label = [&] {
    const float gate = options_.label.gate;
    is_smooth = model_.labeller->label_and_smooth_into(frame, gate, options_.smooth, scene.raw, scene.smooth);
    if (!is_smooth) model_.labeller->label_into(frame, gate, scene.raw);
  };
  std::array<double, 2> took_ms{};
  parallel_for(2, [&](int i) { took_ms[i] = elapsed_ms([&] { i == 0 ? find_planes() : label(); }); });
  clock.lap({Stage::planes, Stage::label}, took_ms);
  if (!is_smooth) mean_filter(scene.raw, frame.depth, frame.camera, options_.smooth, scene.smooth);
  clock.lap(Stage::smooth);
  scene.in_context = !model_.context.empty();
  if (scene.in_context) {
    correct_bodies(model_.context, frame.depth, frame.camera, body(), scene.smooth, scene.corrected);
  }
  clock.lap(Stage::context);
  return scene;
}

LabelImage SceneLabeller::choose(const SceneLabels& scene, const Frame& frame, float background_weight) const {
  LabelOptions options = options_.label;
  options.background_weight = background_weight;
  return choose_labels(scene.posteriors(), frame.depth, {body().part_count()}, options);
}

LabelImage SceneLabeller::choose_raw(const SceneLabels& scene, const Frame& frame) const {
  return choose_labels(scene.raw, frame.depth, {body().part_count()}, options_.label);
}

PersonLabels SceneLabeller::label_person(const SceneLabels& scene, const Frame& frame, const Mask& person,
                                         const Box& box) const {
  if (box.width == 0) return {LabelImage(frame.camera.width, frame.camera.height, kBackground), {}, 0.F};
  Posteriors anew;
  if (model_.labeller->label_person_into(frame, person, box, options_.smooth, anew)) {
    return label_with(anew, box, frame, person, box);
  }
  if (model_.headings.empty() || scene.raw.headings != model_.headings.headings) {
    return label_with(scene.posteriors(), {0, 0, frame.camera.width, frame.camera.height}, frame, person, box);
  }
  const Eigen::VectorXf heading = facing(model_.headings, facing_features(scene.raw, body().part_count(), person, box));
  const Box around = grown(box, smooth_window(options_.smooth, frame.camera).reach(), frame.camera);
  Posteriors turned;
  turn_posteriors(scene.raw, sides_, heading, around, turned);
  mean_filter(turned, crop(frame.depth, around), frame.camera, options_.smooth, anew);
  PersonLabels result = label_with(anew, around, frame, person, box);
  result.facing = heading;
  return result;
}

/// Chooses a person's labels by posteriors of the pixels in `of`, which is as large as `box` or larger.
PersonLabels SceneLabeller::label_with(const Posteriors& posteriors, const Box& of, const Frame& frame,
                                       const Mask& person, const Box& box) const {
  const int parts = body().part_count();
  const Mask inside = crop(person, of);
  const Box within{box.u - of.u, box.v - of.v, box.width, box.height};
  const LabelImage labels = choose_labels(posteriors, crop(frame.depth, of), {parts, &inside, &within}, options_.label);
  PersonLabels result{uncropped(labels, of, frame.camera, kBackground), {}, mean_certainty(posteriors, inside, parts)};
  result.points = sample_points(frame.depth, frame.camera, result.labels, box, posteriors, of, parts);
  return result;
}

}  // namespace vesalius
