#include "train/training_memory.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "train/leaves/prune_tree.h"
#include "train/messages/training_messages.h"

namespace vesalius {
namespace {

constexpr std::uint64_t kGrowing = 2;                          ///< largest ratio of a vector's capacity to its size
constexpr std::uint64_t kRowBytes = 2 * kBlockCandidates + 5;  ///< a sample's values, label and number
constexpr std::uint64_t kPerSample = 4 + 4 + 1;                ///< its node, row and side
constexpr double kEmptyShare = 0.2;  ///< largest share of empty synthetic frames, whose pool is larger
constexpr double kEmptyPool = 4.0;

double background_share(const FrameGroup& group, const TrainOptions& options) {
  return group.empty ? 1.0 : static_cast<double>(options.sample.background_share);
}

/// Returns the samples of one frame, without hard negatives.
double samples_of_frame(const FrameGroup& group, const TrainOptions& options) {
  const double pixels = options.sample.pixels_per_frame;
  return group.empty ? pixels * static_cast<double>(options.sample.background_share) : pixels;
}

std::uint64_t tree_bytes(std::uint64_t samples, int class_count, const TrainOptions& options) {
  const auto least = static_cast<std::uint64_t>(std::max(1, options.grow.leaf.min_samples));
  const std::uint64_t level_nodes = samples / (2 * least) + 1;
  const std::uint64_t nodes = 2 * (samples / least) + 1;
  const std::uint64_t rows = std::min<std::uint64_t>(samples * kRowBytes, options.grow.row_bytes + samples * 5);
  return samples * kPerSample + rows + kGrowing * nodes * (sizeof(GrownNode) + sizeof(TreeNode)) +
         2 * level_nodes * static_cast<std::uint64_t>(class_count) * sizeof(std::int64_t);
}

std::uint64_t leaves_bytes(std::uint64_t samples, int class_count, const TrainOptions& options) {
  if (options.leaves.rounds == 0 || options.sample.background_share <= 0.F) return 0;
  const auto least = static_cast<std::uint64_t>(std::max(1, options.grow.leaf.min_samples));
  const std::uint64_t leaves = samples / least + 1;
  const auto logits = static_cast<std::uint64_t>(class_count + kSides * options.leaves.headings + LogitSoftmax::kLanes);
  // Logits now and at the start, the gradient, and the samples' weights.
  const std::uint64_t of_logit = 2 * sizeof(std::int16_t) + sizeof(std::int32_t) + sizeof(float);
  const std::uint64_t of_tree = samples * sizeof(std::uint32_t) + leaves * logits * of_logit;
  return of_tree * static_cast<std::uint64_t>(options.trees);
}

std::vector<FrameGroup> scaled(std::span<const FrameGroup> groups, double share) {
  std::vector<FrameGroup> fewer(groups.begin(), groups.end());
  for (FrameGroup& group : fewer) {
    group.frames = static_cast<std::uint64_t>(std::floor(static_cast<double>(group.frames) * share));
  }
  return fewer;
}

/// Returns the largest of 0 .. most that `fits`, provided that all below it fit.
template <class Fits>
int largest(int most, const Fits& fits) {
  int low = 0;
  for (int high = most; low < high;) {
    const int middle = low + (high - low + 1) / 2;
    if (fits(middle)) {
      low = middle;
    } else {
      high = middle - 1;
    }
  }
  return low;
}

}  // namespace

std::uint64_t expected_samples(std::span<const FrameGroup> groups, const TrainOptions& options) {
  double samples = 0.0;
  for (const FrameGroup& group : groups) {
    samples += static_cast<double>(group.frames) * samples_of_frame(group, options);
  }
  return static_cast<std::uint64_t>(samples * (1.0 - static_cast<double>(options.sample.held_out_share)));
}

TrainingMemory training_memory(std::span<const FrameGroup> groups, const TrainOptions& options, int class_count) {
  TrainingMemory memory;
  double samples = 0.0, pool = 0.0, hard = 0.0;
  for (const FrameGroup& group : groups) {
    memory.depth += group.frames * group.frame_bytes;
    const double of_group = static_cast<double>(group.frames) * samples_of_frame(group, options);
    samples += of_group;
    hard += of_group * background_share(group, options) * static_cast<double>(options.sample.hard_share);
    const double empty = group.empty ? 1.0 : kEmptyShare;
    pool += static_cast<double>(group.frames) * options.sample.hard_pool * (1.0 + empty * (kEmptyPool - 1.0));
  }
  const bool hard_round = options.hard_trees > 0 && options.sample.background_share > 0.F;
  hard = hard_round ? std::min(hard, pool) : 0.0;
  if (options.sample.background_share <= 0.F) pool = 0.0;
  const auto all = static_cast<std::uint64_t>(samples + hard);
  memory.samples = kGrowing * (all + static_cast<std::uint64_t>(pool)) * sizeof(TrainingSample);
  memory.tree = tree_bytes(all, class_count, options);
  memory.leaves = leaves_bytes(all, class_count, options);
  return memory;
}

TrainingFit training_fit(std::span<const FrameGroup> groups, const TrainOptions& options, int class_count,
                         std::uint64_t bytes) {
  constexpr int kSteps = 1000;
  TrainingFit fit;
  fit.frame_share = largest(kSteps,
                            [&](int step) {
                              const std::vector<FrameGroup> fewer = scaled(groups, static_cast<double>(step) / kSteps);
                              return training_memory(fewer, options, class_count).total(1) <= bytes;
                            }) /
                    static_cast<double>(kSteps);
  fit.pixels = largest(options.sample.pixels_per_frame, [&](int pixels) {
    TrainOptions fewer = options;
    fewer.sample.pixels_per_frame = pixels;
    return training_memory(groups, fewer, class_count).total(1) <= bytes;
  });
  return fit;
}

}  // namespace vesalius
