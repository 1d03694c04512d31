#include "train/best_split.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace vesalius {
namespace {

/// Bits: what rounding alone may seem to gain.
constexpr double kLeastGain = 1e-9;

/// Counts of the classes on one side of a threshold, and sum of n log2 n over them.
struct Side {
  std::vector<std::int32_t> counts;
  std::int64_t total = 0;
  double sum = 0.0;

  void change(std::size_t label, std::int32_t by, const EntropyTable& entropy) {
    sum += entropy(counts[label] + by) - entropy(counts[label]);
    counts[label] += by;
    total += by;
  }
  /// Pixels times entropy, bits.
  double disorder(const EntropyTable& entropy) const { return entropy(total) - sum; }
};

/// A probe uniform in angle and distance: denser near the pixel, where parts differ.
void draw_probe(const FeatureConvention& convention, float max_offset_m, Random& random, std::int16_t& du,
                std::int16_t& dv) {
  const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double largest = max_offset_m * convention.reference_focal_px / convention.offset_unit;
  const double units = std::min<double>(largest, kMaxOffset) * random.uniform();
  du = static_cast<std::int16_t>(std::lround(units * std::cos(angle)));
  dv = static_cast<std::int16_t>(std::lround(units * std::sin(angle)));
}

/// Every second pair has one probe at the pixel itself (Shotton et al. 2011).
TreeNode draw_offsets(const FeatureConvention& convention, float max_offset_m, Random& random) {
  TreeNode node;
  draw_probe(convention, max_offset_m, random, node.du1, node.dv1);
  if (random.below(2) == 0) draw_probe(convention, max_offset_m, random, node.du2, node.dv2);
  return node;
}

/// Thresholds where the node's own pixels lie.
std::vector<int> draw_thresholds(const TreeNode& node, std::span<const TrainingPixel> pixels,
                                 const std::vector<LabelledFrame>& frames, const FeatureConvention& convention,
                                 int count, Random& random) {
  std::vector<int> thresholds;
  for (int i = 0; i < count; ++i) {
    const TrainingPixel& pixel = pixels[random.below(static_cast<std::uint32_t>(pixels.size()))];
    const int feature = feature_of(pixel, frames, convention, node);
    thresholds.push_back(
        std::clamp<int>(feature, std::numeric_limits<std::int16_t>::min(), std::numeric_limits<std::int16_t>::max()));
  }
  std::ranges::sort(thresholds);
  thresholds.erase(std::unique(thresholds.begin(), thresholds.end()), thresholds.end());
  return thresholds;
}

}  // namespace

EntropyTable::EntropyTable(std::size_t largest) : n_log_n_(largest + 1, 0.0) {
  for (std::size_t n = 2; n <= largest; ++n) {
    n_log_n_[n] = static_cast<double>(n) * std::log2(static_cast<double>(n));
  }
}

int feature_of(const TrainingPixel& pixel, const std::vector<LabelledFrame>& frames,
               const FeatureConvention& convention, const TreeNode& node) {
  const DepthImage& depth = frames[static_cast<std::size_t>(pixel.frame)].frame.depth;
  return feature_mm(depth, convention, pixel.scale, pixel.u, pixel.v, node);
}

std::vector<IntervalCounts> count_intervals(std::span<const Candidate> candidates,
                                            std::span<const TrainingPixel> pixels,
                                            const std::vector<LabelledFrame>& frames,
                                            const FeatureConvention& convention, int classes) {
  std::vector<IntervalCounts> result;
  for (const Candidate& candidate : candidates) {
    result.push_back({classes, std::vector<std::int32_t>((candidate.thresholds.size() + 1) * classes, 0)});
  }
  for (const TrainingPixel& pixel : pixels) {
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      const int feature = feature_of(pixel, frames, convention, candidates[c].offsets);
      // Counting beats searching: no branches, and the compiler compares several at once.
      int interval = 0;
      for (const int threshold : candidates[c].thresholds) interval += feature > threshold ? 1 : 0;
      ++result[c].counts[static_cast<std::size_t>(interval * classes + pixel.label)];
    }
  }
  return result;
}

Split best_threshold(const Candidate& candidate, const IntervalCounts& intervals, int min_leaf_pixels,
                     const EntropyTable& entropy) {
  const auto classes = static_cast<std::size_t>(intervals.classes);
  Side left{std::vector<std::int32_t>(classes, 0)}, right = left;
  for (std::size_t i = 0; i < intervals.counts.size(); ++i) right.counts[i % classes] += intervals.counts[i];
  for (const std::int32_t count : right.counts) {
    right.total += count;
    right.sum += entropy(count);
  }
  const double whole = right.disorder(entropy);
  const auto pixels = static_cast<double>(right.total);

  Split best{candidate.offsets, 0.0};
  for (std::size_t t = 0; t < candidate.thresholds.size(); ++t) {
    for (std::size_t c = 0; c < classes; ++c) {
      const std::int32_t moved = intervals.counts[t * classes + c];
      if (moved == 0) continue;
      left.change(c, moved, entropy);
      right.change(c, -moved, entropy);
    }
    if (left.total < min_leaf_pixels || right.total < min_leaf_pixels) continue;
    const double gain = (whole - left.disorder(entropy) - right.disorder(entropy)) / pixels;
    if (gain <= std::max(best.gain, kLeastGain)) continue;
    best.gain = gain;
    best.node.threshold_mm = static_cast<std::int16_t>(candidate.thresholds[t]);
  }
  return best;
}

Split best_split(std::span<const TrainingPixel> pixels, const std::vector<LabelledFrame>& frames,
                 const FeatureConvention& convention, int classes, const SplitOptions& options,
                 const EntropyTable& entropy, Random& random) {
  std::vector<Candidate> candidates;
  for (int i = 0; i < options.candidates; ++i) {
    const TreeNode offsets = draw_offsets(convention, options.max_offset_m, random);
    candidates.push_back({offsets, draw_thresholds(offsets, pixels, frames, convention, options.thresholds, random)});
  }
  const std::vector<IntervalCounts> intervals = count_intervals(candidates, pixels, frames, convention, classes);
  Split best;
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    const Split split = best_threshold(candidates[c], intervals[c], options.min_leaf_pixels, entropy);
    if (split.gain > best.gain) best = split;
  }
  return best;
}

}  // namespace vesalius
