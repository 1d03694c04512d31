#include "train/samples/walk_samples.h"

#include <algorithm>
#include <cstddef>

#include "vesalius/forest/packed_tree.h"
#include "vesalius/forest/padded_depth.h"
#include "vesalius/forest/walk_kernels.h"
#include "vesalius/forest/walk_pixels.h"
#include "vesalius/parallel.h"

namespace vesalius {
namespace {

constexpr int kGrain = 32;  ///< frames that a thread takes at a time
/// Walks in a frame from which unpacking all of it is worthwhile.
constexpr std::size_t kManyWalks = 200;

DepthImage unpacked(const FrameStore::View& view, std::vector<std::uint16_t>& tiles) {
  const TileGrid grid = view.depth.grid;
  tiles.resize(grid.tiles() * TileGrid::kPixels);
  unpack_tiles(view.depth, 0, tiles.data());
  DepthImage depth(grid.width, grid.height);
  for (int v = 0; v < grid.height; ++v) {
    std::uint16_t* row = depth.row(v);
    for (int u = 0; u < grid.width; u += TileGrid::kWidth) {
      const std::uint16_t* from = tiles.data() + grid.tile_of(u, v) * TileGrid::kPixels + TileGrid::in_tile(0, v);
      std::copy_n(from, std::min(TileGrid::kWidth, grid.width - u), row + u);
    }
  }
  return depth;
}

/// The samples of one frame.
struct Run {
  std::size_t begin = 0, end = 0;
};

std::vector<Run> runs_of(std::span<const TrainingSample> samples, const std::function<bool(std::uint32_t)>& wanted) {
  std::vector<Run> runs;
  for (std::size_t i = 0; i < samples.size();) {
    Run run{i, i};
    while (run.end < samples.size() && samples[run.end].frame == samples[i].frame) ++run.end;
    if (wanted(samples[i].frame)) runs.push_back(run);
    i = run.end;
  }
  return runs;
}

}  // namespace

std::vector<std::vector<std::uint32_t>> find_leaves(const std::vector<const Tree*>& trees, const FrameStore& frames,
                                                    std::span<const TrainingSample> samples,
                                                    const std::function<bool(std::uint32_t)>& wanted) {
  const FeatureConvention& convention = frames.convention();
  std::vector<std::vector<std::uint32_t>> leaves(trees.size(), std::vector<std::uint32_t>(samples.size(), 0));
  std::vector<PackedTree> packed;
  std::vector<std::size_t> walked;  // trees of a single leaf need no walk
  for (std::size_t t = 0; t < trees.size(); ++t) {
    if (trees[t]->nodes.empty()) continue;
    packed.push_back(pack(*trees[t], convention));
    walked.push_back(t);
  }
  if (walked.empty()) return leaves;
  const std::vector<Run> runs = runs_of(samples, wanted);
  parallel_ranges(int(runs.size()), kGrain, [&](int first, int last) {
    std::vector<std::uint16_t> tiles;
    std::vector<std::uint32_t> found;
    for (int r = first; r < last; ++r) {
      const Run run = runs[r];
      const FrameStore::View& view = frames[samples[run.begin].frame];
      const bool fits = std::max(view.depth.grid.width, view.depth.grid.height) <= PaddedDepth::kMaxSide;
      if (!fits || (run.end - run.begin) * walked.size() < kManyWalks) {
        for (const std::size_t t : walked) {
          for (std::size_t i = run.begin; i < run.end; ++i) {
            leaves[t][i] = static_cast<std::uint32_t>(leaf_of(*trees[t], frames, samples[i]));
          }
        }
        continue;
      }
      const PaddedDepth depth(unpacked(view, tiles), convention);
      WalkPixels pixels(run.end - run.begin, view.scaler, convention);
      for (std::size_t i = run.begin; i < run.end; ++i) pixels.add(samples[i].u, samples[i].v, samples[i].depth_mm);
      found.resize(pixels.padded_size());
      for (std::size_t w = 0; w < walked.size(); ++w) {
        walk_pixels(packed[w], depth, pixels, found.data());
        std::copy_n(found.begin(), pixels.size(), leaves[walked[w]].begin() + static_cast<std::ptrdiff_t>(run.begin));
      }
    }
  });
  return leaves;
}

}  // namespace vesalius
