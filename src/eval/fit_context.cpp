#include "eval/fit_context.h"

#include <cstdint>
#include <optional>
#include <string>

#include "vesalius/base/blended_depth.h"
#include "vesalius/base/pixel_grid.h"
#include "vesalius/base/random.h"
#include "vesalius/forest/body_context.h"
#include "vesalius/forest/label_scene.h"

namespace vesalius {
namespace {

std::uint64_t seed_of(const std::string& name) {
  std::uint64_t seed = 14695981039346656037ULL;  // FNV-1a, so that it is the same everywhere
  for (const char c : name) seed = (seed ^ static_cast<std::uint8_t>(c)) * 1099511628211ULL;
  return seed;
}

}  // namespace

std::vector<BoostSample> context_samples(const TrueFrame& frame, const std::shared_ptr<const PixelLabeller>& labeller,
                                         const DetectOptions& options) {
  if (frame.truth.labels.empty() || !labeller->has_background()) return {};
  Frame seen = frame.frame;
  if (std::optional<DepthImage> kept = without_blended(seen.depth, options.blend)) seen.depth = std::move(*kept);
  const int step = grid_step(seen.camera, options.grid);
  if (step > 1) seen = every_nth(seen, step);
  const LabelImage truth = every_nth(frame.truth.labels, step);
  StageClock clock(nullptr);
  const SceneLabels scene =
      SceneLabeller(labeller, {options.label, options.smooth, options.grow.plane}).label_scene(seen, clock);
  const BodySurroundings around(scene.posteriors(), seen.depth, seen.camera, labeller->body());
  Random random(seed_of(frame.frame.name));
  std::vector<BoostSample> samples;
  for (int row = 0; row < around.rows(); ++row) {
    for (int column = 0; column < around.columns(); ++column) {
      if (!around.is_open(column, row) || random.below(kContextEvery) != 0) continue;
      BoostSample& sample = samples.emplace_back();
      sample.features.resize(BodySurroundings::feature_count(labeller->body()));
      around.features(column, row, sample.features.data());
      sample.positive = truth(column * around.step(), row * around.step()) != kBackground;
    }
  }
  return samples;
}

}  // namespace vesalius
