#pragma once

#include <algorithm>
#include <cstdint>

#include "train/frame_store.h"
#include "train/training_sample.h"
#include "vesalius/forest/forest.h"

namespace vesalius {

/// Eq. 1 at a sample, as `feature_mm` computes it from a depth image. `read(u, v)`: what a probe inside the picture
/// reads, mm, holes as the convention has it.
template <class Read>
int feature_from(const OffsetScaler& scaler, TileGrid grid, const FeatureConvention& convention,
                 const TrainingSample& sample, const TreeNode& node, const Read& read) {
  const OffsetScale scale = scaler.at(sample.depth_mm);
  const auto probe = [&](int du, int dv) -> int {
    const int u = sample.u + ((du * scale.u + 32768) >> 16);
    const int v = sample.v + ((dv * scale.v + 32768) >> 16);
    return u < 0 || v < 0 || u >= grid.width || v >= grid.height ? convention.outside_mm : read(u, v);
  };
  int first = probe(node.du1, node.dv1);
  int second = probe(node.du2, node.dv2);
  if (convention.clip_mm != 0) {
    const int low = sample.depth_mm - convention.clip_mm;
    const int high = sample.depth_mm + convention.clip_mm;
    first = std::clamp(first, low, high);
    second = std::clamp(second, low, high);
  }
  return first - second;
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

/// Index of the leaf that a sample reaches.
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
