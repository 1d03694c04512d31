#pragma once

// How a node's split is chosen, in steps that a cluster can run as map and reduce, since each of them sees rows of a
// shard only and what they make can be merged:
//   ValueRanges      smallest and largest value of every candidate;          merged by minimum and maximum
//   SplitHistogram   samples by candidate, class and bin of the value;       merged by addition
//   best_split       over the whole histogram, integers only
//   refine_split     the best threshold within the two bins beside it
// Integers make the result independent of the order of merging.

#include <cstdint>
#include <span>
#include <vector>

#include "vesalius/forest/forest.h"

namespace vesalius {

/// Candidates that one histogram holds: as many as keep it in the second-level cache.
inline constexpr int kBlockCandidates = 64;

/// Values of up to kBlockCandidates candidates at samples of one node: row after row of `width` numbers (mm).
struct FeatureRows {
  const std::int16_t* values = nullptr;
  const std::uint8_t* labels = nullptr;  ///< class of each row
  std::size_t rows = 0;
  int width = 0;  ///< multiple of 16, at most kBlockCandidates
};

/// 1024 n log2 n, rounded: entropies as integers. Sums over the classes of a node stay below 2^31.
class EntropyTable {
 public:
  static constexpr int kLargest = 65535;
  EntropyTable();
  std::int32_t operator()(std::int64_t n) const { return values_[n]; }
  const std::int32_t* data() const { return values_.data(); }
  static constexpr double kUnitsPerBit = 1024.0;

 private:
  std::vector<std::int32_t> values_;
};

/// Smallest and largest value of each candidate.
struct ValueRanges {
  std::vector<std::int16_t> low, high;

  explicit ValueRanges(int width);
  void add(const FeatureRows& rows);
  void merge(const ValueRanges& other);
};

/// How many bins a node of so many samples uses: few samples do not tell many apart.
int bins_for(std::int64_t samples, int most);

/// How values become bins: bin = (2 min(value - low, 32767) * factor) >> 16.
struct Binning {
  int bins = 0;
  std::vector<std::int16_t> low;
  std::vector<std::uint16_t> factor;

  Binning(const ValueRanges& ranges, int bins);
  int bin_of(int candidate, int value) const;
  /// Largest value whose bin is not above `bin`.
  int last_value(int candidate, int bin) const;
};

/// Which classes a node has, renumbered without gaps.
struct ClassIndex {
  std::vector<std::uint8_t> index;   ///< [class]
  std::vector<std::int32_t> totals;  ///< [renumbered class]: samples counted
  std::size_t size() const { return totals.size(); }
};
ClassIndex index_classes(const FeatureRows& rows, int classes);

/// counts[(class * bins + bin) * kBlockCandidates + candidate], at most 65,535 samples in all.
struct SplitHistogram {
  int bins = 0;
  std::size_t classes = 0;
  std::vector<std::uint16_t> counts;

  void reset(std::size_t class_count, int bin_count);
  void add(const FeatureRows& rows, const Binning& binning, const ClassIndex& classes);
  SplitHistogram& operator+=(const SplitHistogram& other);
};

/// The threshold between `bin` and the next of one candidate. `score` = sum over both sides and all classes of
/// n log2 n, less that of the sides: highest where most information is gained; in EntropyTable units.
struct BinSplit {
  int candidate = -1;  ///< -1: none leaves `least` samples on both sides
  int bin = 0;
  std::int32_t score = 0;
};

/// The best over all candidates; the first candidate, then the lowest bin on a tie.
BinSplit best_split(const SplitHistogram& histogram, int candidates, const ClassIndex& classes, int least,
                    const EntropyTable& entropy);

/// A threshold in mm and what it gains, bits a sample.
struct ThresholdSplit {
  int threshold_mm = 0;
  double gain = 0;
};

/// The best threshold of the chosen candidate among all that lie in the bins on either side of `split`: midway between
/// two values that follow each other; the lowest on a tie.
ThresholdSplit refine_split(const FeatureRows& rows, const BinSplit& split, const Binning& binning,
                            const ClassIndex& classes, int least, const EntropyTable& entropy);

}  // namespace vesalius
