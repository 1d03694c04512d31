#include "train/split_histogram.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <utility>

#include "train/split_kernels.h"

namespace vesalius {
namespace {

/// The samples on both sides of a rising threshold.
class Sides {
 public:
  Sides(const ClassIndex& classes, const EntropyTable& entropy)
      : entropy_(entropy), left_(classes.size(), 0), right_(classes.totals) {
    for (const std::int32_t n : right_) {
      right_total_ += n;
      sum_ += entropy_(n);
    }
  }
  /// Moves samples of a renumbered class to the left.
  void move(std::size_t label, std::int32_t count = 1) {
    sum_ -= entropy_(left_[label]) + entropy_(right_[label]);
    left_[label] += count;
    right_[label] -= count;
    sum_ += entropy_(left_[label]) + entropy_(right_[label]);
    left_total_ += count;
    right_total_ -= count;
  }
  std::int64_t score() const { return sum_ - entropy_(left_total_) - entropy_(right_total_); }
  std::int64_t smaller() const { return std::min(left_total_, right_total_); }

 private:
  const EntropyTable& entropy_;
  std::vector<std::int32_t> left_, right_;
  std::int64_t left_total_ = 0, right_total_ = 0, sum_ = 0;
};

}  // namespace

NodeValues node_values(const FeatureRows& rows, int classes) {
  NodeValues values{std::vector<std::int32_t>(classes, 0), ValueRanges(rows.width)};
  for (std::size_t r = 0; r < rows.rows; ++r) ++values.class_counts[rows.labels[r]];
  kernels::update_ranges(rows, values.ranges.low.data(), values.ranges.high.data());
  return values;
}

SplitHistogram count_bins(const FeatureRows& rows, const CountTask& task) {
  SplitHistogram histogram(task.classes.size(), task.binning.bins);
  kernels::count_rows(rows, task.binning, task.classes.index.data(), histogram.counts.data());
  return histogram;
}

IntervalValues values_in(const FeatureRows& rows, const ValueInterval& interval) {
  IntervalValues found;
  for (std::size_t r = 0; r < rows.rows; ++r) {
    const std::int16_t value = rows.values[r * rows.width + interval.candidate];
    if (value > interval.above && value <= interval.last) found.values.push_back({value, rows.labels[r]});
  }
  return found;
}

BinSplit best_split(const SplitHistogram& histogram, int candidates, const ClassIndex& classes, int least,
                    const EntropyTable& entropy) {
  std::array<std::int32_t, kBlockCandidates> scores, bins;
  kernels::scan_bins(histogram, classes.totals.data(), least, entropy, scores.data(), bins.data());
  BinSplit best{-1, 0, std::numeric_limits<std::int32_t>::min()};
  for (int c = 0; c < candidates; ++c) {
    if (scores[c] > best.score) best = {c, bins[c], scores[c]};
  }
  return best;
}

BinChoice choose_bin(const SplitHistogram& histogram, int candidates, const ClassIndex& classes, int least,
                     const EntropyTable& entropy) {
  BinChoice choice{best_split(histogram, candidates, classes, least, entropy), {}};
  choice.below.assign(classes.size(), 0);
  for (std::size_t k = 0; choice.split.candidate >= 0 && k < classes.size(); ++k) {
    for (int bin = 0; bin < choice.split.bin; ++bin) choice.below[k] += histogram.at(k, bin, choice.split.candidate);
  }
  return choice;
}

ValueInterval beside(const BinSplit& split, const Binning& binning, int node) {
  const std::int32_t above =
      split.bin > 0 ? binning.last_value(split.candidate, split.bin - 1) : std::numeric_limits<std::int32_t>::min();
  return {node, split.candidate, above, binning.last_value(split.candidate, split.bin + 1)};
}

ThresholdSplit refine_split(IntervalValues values, const BinChoice& choice, const ClassIndex& classes, int least,
                            const EntropyTable& entropy) {
  Sides sides(classes, entropy);
  const std::int64_t before = sides.score();  // the score with all samples on one side
  for (std::size_t k = 0; k < classes.size(); ++k) sides.move(k, choice.below[k]);
  std::vector<LabelledValue>& around = values.values;
  std::ranges::sort(around, {}, &LabelledValue::value);
  std::int64_t best = std::numeric_limits<std::int64_t>::min();
  ThresholdSplit result;
  for (std::size_t i = 0; i < around.size(); ++i) {
    sides.move(classes.index[around[i].label]);
    const int here = around[i].value;
    const int next = i + 1 < around.size() ? around[i + 1].value : here + 1;
    if (here == next || sides.smaller() < least || sides.score() <= best) continue;
    best = sides.score();
    result.threshold_mm = (here + next) >> 1;  // rounded towards minus infinity, so it is never `next`
  }
  if (best == std::numeric_limits<std::int64_t>::min()) return result;
  const std::int64_t samples = std::accumulate(classes.totals.begin(), classes.totals.end(), std::int64_t{0});
  result.gain = double(best - before) / (EntropyTable::kUnitsPerBit * double(samples));
  return result;
}

RowSplit split_of(const FeatureRows& rows, int classes, int bins, int candidates, int least,
                  const EntropyTable& entropy) {
  const NodeValues values = node_values(rows, classes);
  const CountTask task{{values.ranges, bins}, ClassIndex(values.class_counts)};
  const SplitHistogram histogram = count_bins(rows, task);
  const BinChoice best = choose_bin(histogram, candidates, task.classes, least, entropy);
  if (best.split.candidate < 0) return {};
  IntervalValues around = values_in(rows, beside(best.split, task.binning, 0));
  return {best.split.candidate, refine_split(std::move(around), best, task.classes, least, entropy)};
}

}  // namespace vesalius
