#include "metrics/fit_context.h"

#include <cstdint>
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
  const SceneLabeller scenes(labeller, {options.label, options.smooth, options.grow.plane});
  Frame memory;
  const Frame& seen = without_blended(frame.frame, options.blend, memory);
  const auto sample = [&](const Frame& grid, int step) {
    StageClock clock(nullptr);
    const SceneLabels scene = scenes.label_scene(grid, clock);
    const BodySurroundings around(scene.posteriors(), grid.depth, grid.camera, labeller->body());
    const int apart = step * around.step();
    Random random(seed_of(frame.frame.name));
    std::vector<BoostSample> samples;
    for (int row = 0; row < around.rows(); ++row) {
      for (int column = 0; column < around.columns(); ++column) {
        if (!around.is_open(column, row) || random.below(kContextEvery) != 0) continue;
        BoostSample& cell = samples.emplace_back();
        cell.features.resize(BodySurroundings::feature_count(labeller->body()));
        around.features(column, row, cell.features.data());
        cell.positive = frame.truth.labels(column * apart, row * apart) != kBackground;
      }
    }
    return samples;
  };
  return on_grid(seen, options.grid, nullptr, sample, [](const GridGuide&, const std::vector<BoostSample>&) {});
}

}  // namespace vesalius
