#include "train/messages/training_messages.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vesalius/error.h"

namespace vesalius {
namespace {

using detail::expect_alike;

constexpr int kLargestRange = 32767;

}  // namespace

void detail::expect_alike(bool alike, const char* what) {
  if (!alike) throw Error(std::string("training: two shards replied with other numbers of ") + what);
}

ValueRanges::ValueRanges(int candidates)
    : low(candidates, std::numeric_limits<std::int16_t>::max()),
      high(candidates, std::numeric_limits<std::int16_t>::min()) {}

void merge(ValueRanges& all, const ValueRanges& other) {
  expect_alike(all.low.size() == other.low.size(), "candidates");
  for (std::size_t c = 0; c < all.low.size(); ++c) {
    all.low[c] = std::min(all.low[c], other.low[c]);
    all.high[c] = std::max(all.high[c], other.high[c]);
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
    if (span < 1) continue;  // no samples
    factor[c] = static_cast<std::uint16_t>(32768 * std::min(bins, span) / span);
  }
}

int Binning::bin_of(int candidate, int value) const {
  const int above = std::min(value - low[candidate], kLargestRange);
  return (2 * above * factor[candidate]) >> 16;
}

int Binning::last_value(int candidate, int bin) const {
  const int twice = 2 * factor[candidate];
  const int above = ((bin + 1) * 65536 - 1) / twice;
  return low[candidate] + (above >= kLargestRange ? 65535 : above);
}

ClassIndex::ClassIndex(std::span<const std::int32_t> class_counts) : index(class_counts.size(), 0) {
  for (std::size_t label = 0; label < class_counts.size(); ++label) {
    if (class_counts[label] == 0) continue;
    index[label] = static_cast<std::uint8_t>(totals.size());
    totals.push_back(class_counts[label]);
  }
}

SplitHistogram::SplitHistogram(std::size_t class_count, int bin_count)
    : bins(bin_count), classes(class_count), counts(class_count * bin_count * kBlockCandidates, 0) {}

void merge(SplitHistogram& all, const SplitHistogram& other) {
  expect_alike(all.bins == other.bins && all.classes == other.classes && all.counts.size() == other.counts.size(),
               "classes or bins");
  for (std::size_t i = 0; i < all.counts.size(); ++i) {
    const int sum = all.counts[i] + other.counts[i];
    if (sum > kMostCounted) throw Error("training: the shards counted more than 65,535 samples of a node");
    all.counts[i] = static_cast<std::uint16_t>(sum);
  }
}

void merge(IntervalValues& all, const IntervalValues& other) {
  all.values.insert(all.values.end(), other.values.begin(), other.values.end());
}

void merge(ChildCounts& all, const ChildCounts& other) {
  expect_alike(all.classes == other.classes, "classes");
  merge(all.counts, other.counts);
}

ChildSizes child_sizes(const ChildCounts& counts) {
  ChildSizes sizes(counts.children(), 0);
  for (std::size_t child = 0; child < sizes.size(); ++child) {
    for (int c = 0; c < counts.classes; ++c) sizes[child] += counts.of(child)[c];
  }
  return sizes;
}

HardCut hard_cut(const HardCounts& all, std::uint64_t most) {
  for (std::size_t share = all.counts.size(); share-- > 0;) {
    if (all.counts[share] > most) return {static_cast<std::uint32_t>(share), most};
    most -= all.counts[share];
  }
  return {};
}

HardCut take_part(HardCut& cut, const HardCounts& own) {
  if (cut.above >= own.counts.size()) return cut;
  const HardCut part{cut.above, std::min(cut.ties, own.counts[cut.above])};
  cut.ties -= part.ties;
  return part;
}

EntropyTable::EntropyTable() : values_(kMostCounted + 1, 0) {
  for (int n = 2; n <= kMostCounted; ++n) {
    values_[n] = static_cast<std::int32_t>(std::lround(kUnitsPerBit * n * std::log2(n)));
  }
}

}  // namespace vesalius
