#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "train/split_kernels.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <limits>
#include <vector>

#include "train/split_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace vesalius::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes16 = hn::CappedTag<std::int16_t, 16>;
using Lanes32 = hn::CappedTag<std::int32_t, 16>;

void UpdateRanges(const FeatureRows& rows, std::int16_t* HWY_RESTRICT low, std::int16_t* HWY_RESTRICT high) {
  const Lanes16 d;
  for (int c = 0; c < rows.width; c += int(hn::Lanes(d))) {
    auto least = hn::LoadU(d, low + c);
    auto most = hn::LoadU(d, high + c);
    const std::int16_t* value = rows.values + c;
    for (std::size_t r = 0; r < rows.rows; ++r, value += rows.width) {
      const auto x = hn::LoadU(d, value);
      least = hn::Min(least, x);
      most = hn::Max(most, x);
    }
    hn::StoreU(least, d, low + c);
    hn::StoreU(most, d, high + c);
  }
}

void CountRows(const FeatureRows& rows, const Binning& binning, const std::uint8_t* class_of,
               std::uint16_t* HWY_RESTRICT counts) {
  const Lanes16 d;
  const hn::RebindToUnsigned<Lanes16> du;
  const std::size_t class_stride = binning.bins * kBlockCandidates;
  const std::size_t width = rows.width;
  alignas(64) std::uint16_t at[kBlockCandidates];
  const std::int16_t* HWY_RESTRICT low = binning.low.data();
  const std::uint16_t* HWY_RESTRICT factor = binning.factor.data();
  const std::int16_t* row = rows.values;
  for (std::size_t r = 0; r < rows.rows; ++r, row += width) {
    for (std::size_t c = 0; c < width; c += hn::Lanes(d)) {
      const auto above = hn::BitCast(du, hn::Sub(hn::LoadU(d, row + c), hn::LoadU(d, low + c)));
      const auto twice = hn::ShiftLeft<1>(hn::Min(above, hn::Set(du, std::uint16_t{32767})));
      const auto bin = hn::MulHigh(twice, hn::LoadU(du, factor + c));
      hn::StoreU(hn::Add(hn::ShiftLeft<6>(bin), hn::Iota(du, static_cast<std::uint16_t>(c))), du, at + c);
    }
    static_assert(kBlockCandidates == 1 << 6);
    std::uint16_t* HWY_RESTRICT into = counts + class_of[rows.labels[r]] * class_stride;
    for (std::size_t c = 0; c < width; ++c) ++into[at[c]];
  }
}

/// Returns the sum of a table's values at each lane.
template <class Vector>
Vector LookUp(const EntropyTable& entropy, Vector n) {
  return hn::GatherIndex(Lanes32(), entropy.data(), n);
}

void ScanBins(const SplitHistogram& histogram, const std::int32_t* totals, std::int32_t least,
              const EntropyTable& entropy, std::int32_t* HWY_RESTRICT scores, std::int32_t* HWY_RESTRICT bins) {
  const Lanes32 d;
  const hn::Rebind<std::uint16_t, Lanes32> narrow;
  const auto lanes = hn::Lanes(d);
  std::int32_t total = 0;
  for (std::size_t k = 0; k < histogram.classes; ++k) total += totals[k];
  std::vector<std::int32_t> left(histogram.classes * lanes);
  const auto all = hn::Set(d, total);
  for (std::size_t c = 0; c < kBlockCandidates; c += lanes) {
    std::ranges::fill(left, 0);
    auto left_total = hn::Zero(d);
    auto best = hn::Set(d, std::numeric_limits<std::int32_t>::min());
    auto best_bin = hn::Zero(d);
    for (int b = 0; b + 1 < histogram.bins; ++b) {
      auto sum = hn::Zero(d);
      for (std::size_t k = 0; k < histogram.classes; ++k) {
        const std::size_t at = (k * histogram.bins + b) * kBlockCandidates + c;
        const auto moved = hn::PromoteTo(d, hn::LoadU(narrow, histogram.counts.data() + at));
        const auto on_left = hn::Add(hn::LoadU(d, left.data() + k * lanes), moved);
        hn::StoreU(on_left, d, left.data() + k * lanes);
        left_total = hn::Add(left_total, moved);
        sum = hn::Add(sum, LookUp(entropy, on_left));
        sum = hn::Add(sum, LookUp(entropy, hn::Sub(hn::Set(d, totals[k]), on_left)));
      }
      const auto right_total = hn::Sub(all, left_total);
      const auto score = hn::Sub(hn::Sub(sum, LookUp(entropy, left_total)), LookUp(entropy, right_total));
      const auto enough = hn::Gt(hn::Min(left_total, right_total), hn::Set(d, least - 1));
      const auto better = hn::And(enough, hn::Gt(score, best));
      best = hn::IfThenElse(better, score, best);
      best_bin = hn::IfThenElse(better, hn::Set(d, b), best_bin);
    }
    hn::StoreU(best, d, scores + c);
    hn::StoreU(best_bin, d, bins + c);
  }
}

}  // namespace vesalius::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vesalius::kernels {

HWY_EXPORT(UpdateRanges);
HWY_EXPORT(CountRows);
HWY_EXPORT(ScanBins);

void update_ranges(const FeatureRows& rows, std::int16_t* low, std::int16_t* high) {
  HWY_DYNAMIC_DISPATCH(UpdateRanges)(rows, low, high);
}

void count_rows(const FeatureRows& rows, const Binning& binning, const std::uint8_t* class_of, std::uint16_t* counts) {
  HWY_DYNAMIC_DISPATCH(CountRows)(rows, binning, class_of, counts);
}

void scan_bins(const SplitHistogram& histogram, const std::int32_t* totals, std::int32_t least,
               const EntropyTable& entropy, std::int32_t* scores, std::int32_t* bins) {
  HWY_DYNAMIC_DISPATCH(ScanBins)(histogram, totals, least, entropy, scores, bins);
}

}  // namespace vesalius::kernels
#endif
