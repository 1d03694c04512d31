#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vesalius/forest/mean_kernel.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <bit>

#include "vesalius/forest/mean_kernel.h"

HWY_BEFORE_NAMESPACE();
namespace vesalius::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Division of 16-bit numbers by a product and shifts, exact (Granlund and Montgomery 1994, figure 4.1).
class Divider {
 public:
  explicit Divider(std::uint32_t divisor) {
    const int bits = std::bit_width(divisor - 1);
    const std::uint32_t factor = 65536U * ((1U << static_cast<unsigned>(bits)) - divisor) / divisor + 1;
    factor_ = static_cast<std::uint16_t>(factor);
    first_shift_ = std::min(bits, 1);
    second_shift_ = std::max(bits - 1, 0);
  }
  template <class Uint16>
  HWY_INLINE Uint16 operator()(Uint16 x) const {
    const Uint16 high = hn::MulHigh(x, hn::Set(hn::DFromV<Uint16>(), factor_));
    const Uint16 rest = hn::ShiftRightSame(hn::Sub(x, high), first_shift_);
    return hn::ShiftRightSame(hn::Add(high, rest), second_shift_);
  }

 private:
  std::uint16_t factor_;
  int first_shift_;
  int second_shift_;
};

/// Means of one row after the other. `Lanes` has no more lanes than there are classes; the last vector of a pixel
/// overlaps the one before.
template <class Lanes>
class RowMean {
  using Uint16 = hn::Vec<Lanes>;

 public:
  RowMean(const Posteriors& posteriors, const DepthImage& depth, const SmoothWindow& window, Posteriors& out)
      : in_(posteriors),
        depth_(depth),
        window_(window),
        reach_(window.reach()),
        out_(out),
        classes_(static_cast<std::size_t>(posteriors.classes)),
        columns_(static_cast<std::size_t>(window.spacing)),
        nearest_(static_cast<std::size_t>(depth.width())),
        furthest_(nearest_.size()),
        sums_(columns_.size()),
        neighbours_(static_cast<std::size_t>(window.most())) {
    for (Columns& columns : columns_) columns.sums.resize(nearest_.size() * classes_);
    for (Sums& sums : sums_) sums.values.resize(classes_ + 2 * hn::Lanes(Lanes()));
    for (int n = 1; n <= window.most(); ++n) dividers_.emplace_back(static_cast<std::uint32_t>(n));
  }

  /// Writes the means of row `v`. It is quicker where the row before was the last one: sums slide.
  void Run(int v) {
    const bool whole = v >= reach_ && v + reach_ < depth_.height() && depth_.width() > 2 * reach_;
    if (whole) SumColumns(v);
    for (Sums& sums : sums_) sums.u = -1;
    for (int u = 0; u < depth_.width(); ++u) {
      std::uint16_t* to = out_.at(u, v);
      if (const int settled = SettledFrom(u, v); settled > 0) {
        std::copy_n(in_.at(u, v), static_cast<std::size_t>(settled) * classes_, to);
        u += settled - 1;
      } else if (depth_(u, v) == 0) {
        std::fill_n(to, classes_, std::uint16_t{0});
      } else if (whole && u >= reach_ && u + reach_ < depth_.width() && AllNear(u, depth_(u, v))) {
        MeanOfColumns(u, v, to);
      } else {
        const std::size_t count = NeighboursOf(u, v);
        Mean(count, dividers_[count - 1], to);
      }
    }
  }

 private:
  /// Sums over the rows of a window, for every column.
  struct Columns {
    int v = -1;  ///< row in the middle of the window; -1: none yet
    std::vector<std::uint16_t> sums;
  };
  /// Sums over the columns of a window.
  struct Sums {
    int u = -1;                         ///< column in the middle of the window; -1: none yet in this row
    std::vector<std::uint16_t> values;  ///< the vectors of MeanOfColumns
  };

  /// Returns the set of row or column `at`: the one that row or column `at - spacing` used before. There are `spacing`
  /// of them, since a window slides by `spacing`.
  template <class Set>
  Set& SetOf(std::vector<Set>& sets, int at) const {
    return sets[at % window_.spacing];
  }

  /// Returns how many pixels in a row are settled, from this one on.
  int SettledFrom(int u, int v) const {
    if (in_.settled.empty()) return 0;
    const std::uint8_t *row = in_.settled.row(v), *first = row + u;
    return int(std::find(first, row + in_.width, std::uint8_t{0}) - first);
  }

  /// Finds, over the window's rows, each column's sum of posteriors and its nearest and furthest depth; a hole counts
  /// as 0.
  void SumColumns(int v) {
    const int spacing = window_.spacing;
    std::copy_n(depth_.row(v - reach_), nearest_.size(), nearest_.begin());
    furthest_ = nearest_;
    for (int nv = v - reach_ + spacing; nv <= v + reach_; nv += spacing) {
      const std::uint16_t* HWY_RESTRICT row = depth_.row(nv);
      Merge(row, nearest_, [](auto a, auto b) { return hn::Min(a, b); });
      Merge(row, furthest_, [](auto a, auto b) { return hn::Max(a, b); });
    }
    const auto add = [](auto a, auto b) { return hn::Add(a, b); };
    Columns& columns = SetOf(columns_, v);
    if (columns.v >= 0 && v == columns.v + spacing) {
      Merge(in_.at(0, columns.v - reach_), columns.sums, [](auto a, auto b) { return hn::Sub(a, b); });
      Merge(in_.at(0, v + reach_), columns.sums, add);
    } else {
      std::copy_n(in_.at(0, v - reach_), columns.sums.size(), columns.sums.begin());
      for (int nv = v - reach_ + spacing; nv <= v + reach_; nv += spacing) Merge(in_.at(0, nv), columns.sums, add);
    }
    columns.v = v;
  }

  /// Sets all[i] to merge(all[i], row[i]) for every i.
  template <class Operation>
  static HWY_INLINE void Merge(const std::uint16_t* HWY_RESTRICT row, std::vector<std::uint16_t>& all,
                               const Operation& merge) {
    const auto each = [&](auto d, std::size_t i) {
      hn::StoreU(merge(hn::LoadU(d, all.data() + i), hn::LoadU(d, row + i)), d, all.data() + i);
    };
    const hn::ScalableTag<std::uint16_t> wide;
    const std::size_t step = hn::Lanes(wide);
    std::size_t i = 0;
    for (; i + step <= all.size(); i += step) each(wide, i);
    for (; i < all.size(); ++i) each(hn::CappedTag<std::uint16_t, 1>(), i);
  }

  bool AllNear(int u, int mm) const {
    int nearest = 65535, furthest = 0;
    for (int nu = u - reach_; nu <= u + reach_; nu += window_.spacing) {
      nearest = std::min<int>(nearest, nearest_[nu]);
      furthest = std::max<int>(furthest, furthest_[nu]);
    }
    return nearest != 0 && mm - nearest <= window_.gate_mm && furthest - mm <= window_.gate_mm;
  }

  /// Writes the mean over a whole window around column `u`. Sums of 16 bits may run over on the way, never at the end.
  HWY_INLINE void MeanOfColumns(int u, int v, std::uint16_t* to) {
    const Lanes d;
    const std::size_t lanes = hn::Lanes(d);
    const std::size_t step = static_cast<std::size_t>(window_.spacing) * classes_;
    const std::uint16_t* first = SetOf(columns_, v).sums.data() + static_cast<std::size_t>(u - reach_) * classes_;
    const std::uint16_t* last = first + static_cast<std::size_t>(2 * window_.each_way) * step;
    Sums& kept = SetOf(sums_, u);
    const bool slides = kept.u >= 0 && kept.u == u - window_.spacing;
    kept.u = u;
    std::uint16_t* sums = kept.values.data();  // the last vector has sums of its own: it overlaps the one before
    for (std::size_t c = 0;; c = std::min(c + lanes, classes_ - lanes), sums += lanes) {
      Uint16 sum;
      if (slides) {
        sum = hn::Add(hn::Sub(hn::LoadU(d, sums), hn::LoadU(d, first - step + c)), hn::LoadU(d, last + c));
      } else {
        sum = hn::LoadU(d, first + c);
        for (const std::uint16_t* at = first + step; at <= last; at += step) sum = hn::Add(sum, hn::LoadU(d, at + c));
      }
      hn::StoreU(sum, d, sums);
      hn::StoreU(dividers_.back()(sum), d, to + c);
      if (c + lanes == classes_) return;
    }
  }

  std::size_t NeighboursOf(int u, int v) {
    std::size_t count = 0;
    for_neighbours(depth_, u, v, window_, [&](int nu, int nv) { neighbours_[count++] = in_.at(nu, nv); });
    return count;
  }

  /// Writes the mean of what the first `count` of `neighbours_` point to.
  HWY_INLINE void Mean(std::size_t count, const Divider& divide, std::uint16_t* to) const {
    const Lanes d;
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t c = 0;; c = std::min(c + lanes, classes_ - lanes)) {
      Uint16 sum = hn::LoadU(d, neighbours_[0] + c);
      for (std::size_t n = 1; n < count; ++n) sum = hn::Add(sum, hn::LoadU(d, neighbours_[n] + c));
      hn::StoreU(divide(sum), d, to + c);
      if (c + lanes == classes_) return;
    }
  }

  const Posteriors& in_;
  const DepthImage& depth_;
  SmoothWindow window_;
  int reach_;
  Posteriors& out_;
  std::size_t classes_;
  std::vector<Columns> columns_;  ///< columns of `spacing` rows
  std::vector<std::uint16_t> nearest_, furthest_;
  std::vector<Sums> sums_;  ///< sums of `spacing` pixels
  std::vector<const std::uint16_t*> neighbours_;
  std::vector<Divider> dividers_;
};

void MeanRows(const Posteriors& posteriors, const DepthImage& depth, const SmoothWindow& window, int begin, int end,
              Posteriors& out) {
  const auto run = [&](auto lanes) {
    RowMean<decltype(lanes)> mean(posteriors, depth, window, out);
    for (int v = begin; v < end; ++v) mean.Run(v);
  };
  const hn::CappedTag<std::uint16_t, 16> many;  // capped, so that the classes of the paper's body fill it
  if (posteriors.classes >= int(hn::Lanes(many))) {
    run(many);
  } else {
    run(hn::CappedTag<std::uint16_t, 1>());
  }
}

}  // namespace vesalius::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vesalius {

HWY_EXPORT(MeanRows);

void mean_rows(const Posteriors& posteriors, const DepthImage& depth, const SmoothWindow& window, int begin, int end,
               Posteriors& out) {
  HWY_DYNAMIC_DISPATCH(MeanRows)(posteriors, depth, window, begin, end, out);
}

}  // namespace vesalius
#endif
