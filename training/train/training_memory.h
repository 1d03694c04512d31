#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "train/grow_forest.h"

namespace vesalius {

/// Frames of one kind for a training set.
struct FrameGroup {
  std::uint64_t frames = 0;
  std::uint64_t frame_bytes = 0;  ///< memory of one frame in FrameStore
  bool empty = false;             ///< whether they are known to show nobody
};

/// The memory of a training in bytes. It is an upper bound if `frame_bytes` are; growing vectors count twice.
struct TrainingMemory {
  std::uint64_t depth = 0;    ///< of all frames
  std::uint64_t samples = 0;  ///< samples with hard negatives and their pool
  std::uint64_t tree = 0;     ///< memory for growing one tree
  std::uint64_t leaves = 0;   ///< memory for learning the leaves of all trees, which begins when they are grown

  std::uint64_t total(int trees_at_once) const {
    return depth + samples + std::max(tree * static_cast<std::uint64_t>(trees_at_once), leaves);
  }
};
TrainingMemory training_memory(std::span<const FrameGroup> groups, const TrainOptions& options, int class_count);

/// Returns the number of samples of `groups`, without held-out ones and hard negatives.
std::uint64_t expected_samples(std::span<const FrameGroup> groups, const TrainOptions& options);

/// The frames or pixels that fit into `bytes` while one tree grows at a time; 0 if nothing fits.
struct TrainingFit {
  double frame_share = 0.0;  ///< share of each group with the requested pixels
  int pixels = 0;            ///< pixels of each frame with the requested frames
};
TrainingFit training_fit(std::span<const FrameGroup> groups, const TrainOptions& options, int class_count,
                         std::uint64_t bytes);

}  // namespace vesalius
