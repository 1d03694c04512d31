#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "train/sample_pixels.h"
#include "vesalius/forest.h"
#include "vesalius/frame.h"
#include "vesalius/random.h"

namespace vesalius {

/// How splits are proposed and judged.
struct SplitOptions {
  int candidates = 50;        ///< pairs of offsets a node tries
  int thresholds = 20;        ///< thresholds each of them tries
  float max_offset_m = 0.5F;  ///< furthest probe; at reference focal length 1
  int min_leaf_pixels = 20;   ///< fewest pixels on either side
};

/// A test of a node and what it is worth.
struct Split {
  TreeNode node;    ///< offsets and threshold; children not set
  double gain = 0;  ///< information gained, bits a pixel; 0 = nothing worth splitting
};

/// n log2 n for counts up to a limit.
class EntropyTable {
 public:
  explicit EntropyTable(std::size_t largest);
  double operator()(std::int64_t count) const { return n_log_n_[static_cast<std::size_t>(count)]; }

 private:
  std::vector<double> n_log_n_;
};

/// Value of eq. 1 at a training pixel, by the code that detection runs.
int feature_of(const TrainingPixel& pixel, const std::vector<LabelledFrame>& frames,
               const FeatureConvention& convention, const TreeNode& node);

/// A pair of offsets and the thresholds to try with it, ascending and distinct.
struct Candidate {
  TreeNode offsets;
  std::vector<int> thresholds;
};

/// How many pixels of each class lie between which thresholds of one candidate:
/// counts[interval * classes + label], interval = number of thresholds below the feature.
struct IntervalCounts {
  int classes = 0;
  std::vector<std::int32_t> counts;
};

/// One pass over the pixels for all candidates: the depth around a pixel is fetched once.
std::vector<IntervalCounts> count_intervals(std::span<const Candidate> candidates,
                                            std::span<const TrainingPixel> pixels,
                                            const std::vector<LabelledFrame>& frames,
                                            const FeatureConvention& convention, int classes);

/// The threshold of the largest gain, the lowest on a tie. Gain 0 where none leaves `min_leaf_pixels` on both sides.
Split best_threshold(const Candidate& candidate, const IntervalCounts& intervals, int min_leaf_pixels,
                     const EntropyTable& entropy);

/// The best of `options.candidates` random pairs of offsets, the first on a tie (section 4.2).
Split best_split(std::span<const TrainingPixel> pixels, const std::vector<LabelledFrame>& frames,
                 const FeatureConvention& convention, int classes, const SplitOptions& options,
                 const EntropyTable& entropy, Random& random);

}  // namespace vesalius
