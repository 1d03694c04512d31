#pragma once

#include <cstdint>
#include <span>

#include "train/grow_forest.h"

namespace vesalius {

/// Frames of one kind that a training set is to hold.
struct FrameGroup {
  std::uint64_t frames = 0;
  std::uint64_t frame_bytes = 0;  ///< that FrameStore takes for one
  bool empty = false;             ///< known to show nobody
};

/// Most bytes that training takes. An upper bound where `frame_bytes` are one; vectors that grow count twice in it.
struct TrainingMemory {
  std::uint64_t depth = 0;    ///< of all frames
  std::uint64_t samples = 0;  ///< with hard negatives and the pool they come from
  std::uint64_t tree = 0;     ///< growing one tree

  std::uint64_t total(int trees_at_once) const {
    return depth + samples + tree * static_cast<std::uint64_t>(trees_at_once);
  }
};
TrainingMemory training_memory(std::span<const FrameGroup> groups, const TrainOptions& options, int class_count);

/// Returns how many samples `groups` give, without held-out ones and hard negatives.
std::uint64_t expected_samples(std::span<const FrameGroup> groups, const TrainOptions& options);

/// What fits into `bytes` while one tree grows at a time; 0 where nothing does.
struct TrainingFit {
  double frame_share = 0.0;  ///< of each group, at the pixels asked for
  int pixels = 0;            ///< of each frame, at the frames asked for
};
TrainingFit training_fit(std::span<const FrameGroup> groups, const TrainOptions& options, int class_count,
                         std::uint64_t bytes);

}  // namespace vesalius
