#pragma once

#include <cstdint>

#include "train/messages/training_sample.h"
#include "train/samples/frame_store.h"
#include "vesalius/forest.h"
#include "vesalius/forest/feature.h"

namespace vesalius {

/// Returns eq. 1 at a sample in mm. `read(u, v)` returns the value in mm of a probe inside the picture, with holes as
/// the convention says.
template <class Read>
int feature_from(const OffsetScaler& scaler, TileGrid grid, const FeatureConvention& convention,
                 const TrainingSample& sample, const TreeNode& node, const Read& read) {
  return feature(sample.u, sample.v, scaler.at(sample.depth_mm), probe_range(sample.depth_mm, convention.clip_mm), node,
                 [&](int u, int v) -> int {
                   const bool inside = u >= 0 && v >= 0 && u < grid.width && v < grid.height;
                   return inside ? read(u, v) : convention.outside_mm;
                 });
}

inline int feature_of(const FrameStore::View& view, const FeatureConvention& convention, const TrainingSample& sample,
                      const TreeNode& node) {
  return feature_from(view.scaler, view.depth.grid, convention, sample, node, [&](int u, int v) -> int {
    const int mm = view.depth.depth_mm(u, v);
    return mm != 0 ? mm : convention.hole_mm;
  });
}

inline int feature_of(const TiledDepth& depth, const FeatureConvention& convention, const TrainingSample& sample,
                      const TreeNode& node) {
  return feature_from(depth.scaler, depth.grid, convention, sample, node,
                      [&](int u, int v) -> int { return depth.depth_mm(u, v); });
}

/// Returns the index of the leaf that a sample reaches.
inline std::size_t leaf_of(const Tree& tree, const FrameStore& frames, const TrainingSample& sample) {
  const FrameStore::View& view = frames[sample.frame];
  std::int32_t at = tree.nodes.empty() ? ~0 : 0;
  while (at >= 0) {
    const TreeNode& node = tree.nodes[at];
    at = feature_of(view, frames.convention(), sample, node) <= node.threshold_mm ? node.left : node.right;
  }
  return static_cast<std::size_t>(~at);
}

}  // namespace vesalius
