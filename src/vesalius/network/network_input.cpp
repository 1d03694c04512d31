#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vesalius/network/network_input.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <array>
#include <cstring>

#include "vesalius/base/pixel_grid.h"
#include "vesalius/network/network_input.h"
#include "vesalius/parallel.h"

HWY_BEFORE_NAMESPACE();
namespace vesalius::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int kAcross = 2;        // pixels to either side by which slopes are measured
constexpr float kSteepest = 3.F;  // of slopes

/// Channels of the pixels of one row, as many at a time as a vector has lanes.
class InputRow {
 public:
  InputRow(const DepthImage& depth, float focal_px, int v, std::uint8_t* to)
      : row_(depth.row(v)),
        to_(to),
        near_(kNetworkSteps * kNearFiner * 2000.F / 285.F * focal_px),
        steep_(kNetworkSteps / float(2 * kAcross) * focal_px) {
    if (v < kAcross || v + kAcross >= depth.height()) return;
    above_ = depth.row(v - kAcross);
    below_ = depth.row(v + kAcross);
  }

  /// Writes the pixels from `u` on. At the picture's sides they have no slope across.
  template <class Lanes>
  HWY_INLINE void Pixels(Lanes d, int u, bool at_side) const {
    const hn::Rebind<float, Lanes> real;
    const auto zero = hn::Set(d, kNetworkZero);
    const auto mm = Depth(d, row_ + u);
    const auto inverse = hn::Div(hn::Set(real, 1.F), hn::ConvertTo(real, hn::Max(mm, hn::Set(d, 1))));
    const auto nearness = hn::Min(hn::Mul(hn::Set(real, near_), inverse), hn::Set(real, 32000.F));
    constexpr float usual = 0.7F * kNetworkSteps * kNearFiner;
    const auto fine = RoundedDown(d, hn::Add(hn::Sub(nearness, hn::Set(real, usual)), hn::Set(real, 0.5F)));
    const auto more = hn::Add(hn::ConvertTo(real, fine), hn::Set(real, 0.5F * kNearFiner));
    const auto coarse = RoundedDown(d, hn::Div(more, hn::Set(real, float(kNearFiner))));
    const auto left = hn::Sub(fine, hn::Mul(coarse, hn::Set(d, kNearFiner)));
    const auto per_mm = hn::Mul(hn::Set(real, steep_), inverse);
    auto across = zero, down = zero;
    if (!at_side) across = Slope(d, Depth(d, row_ + u - kAcross), Depth(d, row_ + u + kAcross), per_mm);
    if (above_ != nullptr) down = Slope(d, Depth(d, above_ + u), Depth(d, below_ + u), per_mm);
    const auto empty = hn::Eq(mm, hn::Zero(d));
    const auto or_zero = [&](auto channel) { return hn::IfThenElse(empty, zero, channel); };
    // Four bytes of a pixel are one number, the first channel the lowest.
    const auto there = hn::Set(d, kNetworkZero + int(kNetworkSteps));
    const auto first = hn::Or(hn::Or(or_zero(Channel(d, coarse)), hn::ShiftLeft<8>(or_zero(Channel(d, left)))),
                              hn::Or(hn::ShiftLeft<16>(or_zero(there)), hn::ShiftLeft<24>(or_zero(across))));
    const auto second = hn::Or(or_zero(down), hn::Set(d, kNetworkZero * 0x01010100));
    std::array<std::int32_t, hn::MaxLanes(d)> low, high;
    hn::StoreU(first, d, low.data());
    hn::StoreU(second, d, high.data());
    std::uint8_t* to = to_ + static_cast<std::ptrdiff_t>(u) * kNetworkInputs;
    for (std::size_t i = 0; i < hn::Lanes(d); ++i, to += kNetworkInputs) {
      std::memcpy(to, &low[i], sizeof low[i]);
      std::memcpy(to + sizeof low[i], &high[i], sizeof high[i]);
    }
  }

 private:
  template <class Lanes>
  static HWY_INLINE hn::Vec<Lanes> Depth(Lanes d, const std::uint16_t* at) {
    return hn::PromoteTo(d, hn::LoadU(hn::Rebind<std::uint16_t, Lanes>(), at));
  }

  /// Rounds down, so that it is the same everywhere; x is above -1024.
  template <class Lanes, class Real>
  static HWY_INLINE hn::Vec<Lanes> RoundedDown(Lanes d, Real x) {
    const auto above = hn::Add(x, hn::Set(hn::DFromV<Real>(), 1024.F));
    return hn::Sub(hn::ConvertTo(d, above), hn::Set(d, 1024));
  }

  template <class Lanes>
  static HWY_INLINE hn::Vec<Lanes> Channel(Lanes d, hn::Vec<Lanes> steps) {
    return hn::Min(hn::Max(hn::Add(steps, hn::Set(d, kNetworkZero)), hn::Zero(d)), hn::Set(d, 255));
  }

  /// Returns the slope between two readings, whose steps from one to the other are `per_mm` each.
  template <class Lanes, class Real>
  static HWY_INLINE hn::Vec<Lanes> Slope(Lanes d, hn::Vec<Lanes> before, hn::Vec<Lanes> after, Real per_mm) {
    const hn::DFromV<Real> real;
    const auto most = hn::Set(real, kSteepest * kNetworkSteps);
    const auto steps = hn::Mul(hn::ConvertTo(real, hn::Sub(after, before)), per_mm);
    const auto within = hn::Min(hn::Max(steps, hn::Neg(most)), most);
    const auto slope = Channel(d, RoundedDown(d, hn::Add(within, hn::Set(real, 0.5F))));
    const auto none = hn::Zero(d);
    return hn::IfThenElse(hn::Or(hn::Eq(before, none), hn::Eq(after, none)), hn::Set(d, kNetworkZero), slope);
  }

  const std::uint16_t *row_, *above_ = nullptr, *below_ = nullptr;
  std::uint8_t* to_;
  float near_, steep_;
};

/// Writes one row: the picture's row `v`, or what stands for rows beyond it.
void FillRow(const DepthImage& depth, float focal_px, int v, int width, std::uint8_t* to) {
  const int begin = v < depth.height() ? depth.width() : 0;
  std::fill_n(to + static_cast<std::ptrdiff_t>(begin) * kNetworkInputs,
              static_cast<std::size_t>(width - begin) * kNetworkInputs, static_cast<std::uint8_t>(kNetworkZero));
  if (begin == 0) return;
  const InputRow row(depth, focal_px, v, to);
  const hn::CappedTag<std::int32_t, 1> one;
  const hn::ScalableTag<std::int32_t> many;
  const int lanes = int(hn::Lanes(many));
  int u = 0;
  for (; u < std::min(kAcross, depth.width()); ++u) row.Pixels(one, u, true);
  for (; u + lanes + kAcross <= depth.width(); u += lanes) row.Pixels(many, u, false);
  for (; u < depth.width(); ++u) row.Pixels(one, u, u + kAcross >= depth.width());
}

}  // namespace vesalius::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vesalius {
namespace {

int padded(int size) { return (size + kNetworkMultiple - 1) / kNetworkMultiple * kNetworkMultiple; }

}  // namespace

HWY_EXPORT(FillRow);

void fill_network_input(const DepthImage& depth, float focal_px, NetworkInput& input) {
  input.width = padded(depth.width());
  input.height = padded(depth.height());
  const std::size_t row = static_cast<std::size_t>(input.width) * kNetworkInputs;
  input.values.resize(row * static_cast<std::size_t>(input.height));
  parallel_ranges(input.height, kRowGrain, [&](int begin, int end) {
    for (int v = begin; v < end; ++v) {
      HWY_DYNAMIC_DISPATCH(FillRow)(depth, focal_px, v, input.width, input.values.data() + std::size_t(v) * row);
    }
  });
}

}  // namespace vesalius
#endif
