#include "train/split_histogram.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "train/split_kernels.h"

namespace vesalius {
namespace {

constexpr int kLargestRange = 32767;

std::size_t at(int candidate) { return static_cast<std::size_t>(candidate); }

/// A value with its class, ordered by value.
struct LabelledValue {
  std::int16_t value;
  std::uint8_t label;  ///< renumbered
};

/// Samples on both sides of a threshold that moves up.
class Sides {
 public:
  Sides(const ClassIndex& classes, const EntropyTable& entropy)
      : entropy_(entropy), left_(classes.size(), 0), right_(classes.totals) {
    for (const std::int32_t n : right_) {
      right_total_ += n;
      sum_ += entropy_(n);
    }
  }
  void move(std::uint8_t label) {
    sum_ -= entropy_(left_[label]) + entropy_(right_[label]);
    ++left_[label];
    --right_[label];
    sum_ += entropy_(left_[label]) + entropy_(right_[label]);
    ++left_total_;
    --right_total_;
  }
  std::int64_t score() const { return sum_ - entropy_(left_total_) - entropy_(right_total_); }
  std::int64_t smaller() const { return std::min(left_total_, right_total_); }

 private:
  const EntropyTable& entropy_;
  std::vector<std::int32_t> left_, right_;
  std::int64_t left_total_ = 0, right_total_ = 0, sum_ = 0;
};

/// Rows whose value lies in the two bins of the split, in order; those below are moved to the left side.
std::vector<LabelledValue> values_around(const FeatureRows& rows, const BinSplit& split, const Binning& binning,
                                         const ClassIndex& classes, Sides& sides) {
  const std::int32_t below =
      split.bin > 0 ? binning.last_value(split.candidate, split.bin - 1) : std::numeric_limits<std::int32_t>::min();
  const std::int32_t last = binning.last_value(split.candidate, split.bin + 1);
  std::vector<LabelledValue> around;
  const std::int16_t* value = rows.values + split.candidate;
  for (std::size_t r = 0; r < rows.rows; ++r, value += rows.width) {
    const std::uint8_t label = classes.index[rows.labels[r]];
    if (*value <= below) {
      sides.move(label);
    } else if (*value <= last) {
      around.push_back({*value, label});
    }
  }
  std::ranges::sort(around, {}, &LabelledValue::value);
  return around;
}

}  // namespace

EntropyTable::EntropyTable() : values_(kLargest + 1, 0) {
  for (int n = 2; n <= kLargest; ++n) {
    values_[at(n)] = static_cast<std::int32_t>(std::lround(kUnitsPerBit * n * std::log2(n)));
  }
}

ValueRanges::ValueRanges(int width)
    : low(at(width), std::numeric_limits<std::int16_t>::max()),
      high(at(width), std::numeric_limits<std::int16_t>::min()) {}

void ValueRanges::add(const FeatureRows& rows) { kernels::update_ranges(rows, low.data(), high.data()); }

void ValueRanges::merge(const ValueRanges& other) {
  for (std::size_t c = 0; c < low.size(); ++c) {
    low[c] = std::min(low[c], other.low[c]);
    high[c] = std::max(high[c], other.high[c]);
  }
}

int bins_for(std::int64_t samples, int most) {
  constexpr std::int64_t kMany = 2048, kSome = 512;
  return std::min(most, samples >= kMany ? 32 : samples >= kSome ? 16 : 8);
}

Binning::Binning(const ValueRanges& ranges, int bin_count)
    : bins(bin_count), low(ranges.low), factor(ranges.low.size(), 0) {
  for (std::size_t c = 0; c < low.size(); ++c) {
    const int span = std::min(ranges.high[c] - ranges.low[c], kLargestRange) + 1;
    if (span < 1) continue;  // no rows
    factor[c] = static_cast<std::uint16_t>(32768 * std::min(bins, span) / span);
  }
}

int Binning::bin_of(int candidate, int value) const {
  const int above = std::min(value - low[at(candidate)], kLargestRange);
  return (2 * above * factor[at(candidate)]) >> 16;
}

int Binning::last_value(int candidate, int bin) const {
  const int twice = 2 * factor[at(candidate)];
  const int above = ((bin + 1) * 65536 - 1) / twice;
  return low[at(candidate)] + (above >= kLargestRange ? 65535 : above);
}

ClassIndex index_classes(const FeatureRows& rows, int classes) {
  std::vector<std::int32_t> counts(at(classes), 0);
  for (std::size_t r = 0; r < rows.rows; ++r) ++counts[rows.labels[r]];
  ClassIndex result;
  result.index.resize(counts.size(), 0);
  for (std::size_t label = 0; label < counts.size(); ++label) {
    if (counts[label] == 0) continue;
    result.index[label] = static_cast<std::uint8_t>(result.totals.size());
    result.totals.push_back(counts[label]);
  }
  return result;
}

void SplitHistogram::reset(std::size_t class_count, int bin_count) {
  bins = bin_count;
  classes = class_count;
  counts.assign(class_count * at(bin_count) * kBlockCandidates, 0);
}

void SplitHistogram::add(const FeatureRows& rows, const Binning& binning, const ClassIndex& index) {
  kernels::count_rows(rows, binning, index.index.data(), counts.data());
}

SplitHistogram& SplitHistogram::operator+=(const SplitHistogram& other) {
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = static_cast<std::uint16_t>(counts[i] + other.counts[i]);
  return *this;
}

BinSplit best_split(const SplitHistogram& histogram, int candidates, const ClassIndex& classes, int least,
                    const EntropyTable& entropy) {
  std::array<std::int32_t, kBlockCandidates> scores, bins;
  kernels::scan_bins(histogram, classes.totals.data(), least, entropy, scores.data(), bins.data());
  BinSplit best{-1, 0, std::numeric_limits<std::int32_t>::min()};
  for (int c = 0; c < candidates; ++c) {
    if (scores[at(c)] > best.score) best = {c, bins[at(c)], scores[at(c)]};
  }
  return best;
}

ThresholdSplit refine_split(const FeatureRows& rows, const BinSplit& split, const Binning& binning,
                            const ClassIndex& classes, int least, const EntropyTable& entropy) {
  Sides sides(classes, entropy);
  const std::int64_t before = sides.score();  // everything on one side
  const std::vector<LabelledValue> around = values_around(rows, split, binning, classes, sides);
  std::int64_t best = std::numeric_limits<std::int64_t>::min();
  ThresholdSplit result;
  for (std::size_t i = 0; i < around.size(); ++i) {
    sides.move(around[i].label);
    const int here = around[i].value;
    const int next = i + 1 < around.size() ? around[i + 1].value : here + 1;
    if (here == next || sides.smaller() < least || sides.score() <= best) continue;
    best = sides.score();
    result.threshold_mm = (here + next) >> 1;  // towards minus infinity, so never `next`
  }
  if (best == std::numeric_limits<std::int64_t>::min()) return result;
  result.gain = static_cast<double>(best - before) / (EntropyTable::kUnitsPerBit * static_cast<double>(rows.rows));
  return result;
}

}  // namespace vesalius
