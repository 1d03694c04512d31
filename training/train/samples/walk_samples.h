#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "train/messages/training_messages.h"
#include "train/samples/frame_store.h"
#include "vesalius/forest.h"
#include "vesalius/forest/feature.h"
#include "vesalius/forest/leaf_logits.h"

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

/// Returns [tree][sample]: the index of the leaf that each sample reaches, as `leaf_of` finds it. The trees' `leaves`
/// may be empty. Samples are ordered by frame; those of frames that are not wanted get 0.
std::vector<std::vector<std::uint32_t>> find_leaves(
    const std::vector<const Tree*>& trees, const FrameStore& frames, std::span<const TrainingSample> samples,
    const std::function<bool(std::uint32_t)>& wanted = [](std::uint32_t /*frame*/) { return true; });

/// What a forest with logits says of samples. Each thread needs its own.
class SampleLogits {
 public:
  /// `forest` must outlive this object.
  explicit SampleLogits(const Forest& forest)
      : forest_(forest),
        layout_(forest.body, forest.has_background, forest.headings),
        reader_(layout_, forest.logit_unit, int(forest.trees.size())),
        logits_(forest.trees.size() * reader_.padded(), 0),
        turns_(static_cast<std::size_t>(kSides) * layout_.headings) {
    for (std::size_t t = 0; t < forest.trees.size(); ++t) leaves_.push_back(logits_.data() + t * reader_.padded());
  }
  SampleLogits(const SampleLogits&) = delete;
  SampleLogits& operator=(const SampleLogits&) = delete;

  const LogitLayout& layout() const { return layout_; }

  /// Writes the posteriors of the classes as LogitReader does.
  void read(const FrameStore& frames, const TrainingSample& sample, std::uint16_t* posteriors) {
    const std::size_t size = layout_.size();
    for (std::size_t t = 0; t < leaves_.size(); ++t) {
      const Tree& tree = forest_.trees[t];
      std::copy_n(tree.logits.data() + leaf_of(tree, frames, sample) * size, size,
                  logits_.data() + t * reader_.padded());
    }
    reader_.read(leaves_.data(), posteriors, turns_.data());
  }
  /// Returns P(side, heading | body) of the last sample, as LogitReader gives it.
  const std::uint16_t* turns() const { return turns_.data(); }

 private:
  const Forest& forest_;
  LogitLayout layout_;
  LogitReader reader_;
  std::vector<std::int8_t> logits_;         ///< logits of the last sample's leaves
  std::vector<const std::int8_t*> leaves_;  ///< where each of them begins
  std::vector<std::uint16_t> turns_;
};

}  // namespace vesalius
