#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vesalius/network/posterior_kernels.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <vector>

#include "vesalius/network/posterior_kernels.h"

#ifndef VESALIUS_NETWORK_POSTERIOR_KERNELS
#define VESALIUS_NETWORK_POSTERIOR_KERNELS
namespace vesalius {
namespace {

constexpr double kHalf = 0.5;  ///< added to what is rounded down, which is the same everywhere

/// exp(-i / 256) of every i, until it is nothing; in 2^-16. By products of doubles, which are the same everywhere.
class Powers {
 public:
  static constexpr int kCount = 2560;  ///< exp(-10) is less than a tenth of the network labeller's shares

  Powers() {
    constexpr double step = 0.99610136947011749;  // exp(-1 / 256)
    double power = 65536.0;
    for (std::size_t i = 0; i < kCount; ++i) {
      powers_[i] = static_cast<std::int32_t>(power + kHalf);
      power *= step;
    }
  }
  /// kCount of them, and a zero.
  const std::int32_t* data() const { return powers_.data(); }

 private:
  std::array<std::int32_t, kCount + 1> powers_{};
};

const std::int32_t* powers() {
  static const Powers all;
  return all.data();
}

}  // namespace
}  // namespace vesalius
#endif

HWY_BEFORE_NAMESPACE();
namespace vesalius::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Calls each(i) for the first index of every vector of `count` numbers; the last vector overlaps the one before.
template <class Lanes, class Each>
HWY_INLINE void ForVectors(Lanes d, std::size_t count, const Each& each) {
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t i = 0;; i = std::min(i + lanes, count - lanes)) {
    each(i);
    if (i + lanes == count) return;
  }
}

/// Makes posteriors of one pixel's logits after the other's. There are more classes than kMost.
template <std::size_t kMost>
class Softmax {
  using Logits = hn::CappedTag<std::int16_t, kMost>;
  using Wide = hn::CappedTag<std::int32_t, (kMost + 1) / 2>;

 public:
  Softmax(int classes, int whole) : classes_(static_cast<std::size_t>(classes)), whole_(whole), power_(classes_) {}

  HWY_INLINE void Run(const std::int16_t* HWY_RESTRICT logits, std::uint16_t* HWY_RESTRICT shares) {
    const int body = LargestOfBody(logits), background = logits[classes_ - 1];
    if (background - body >= Powers::kCount) {
      const hn::CappedTag<std::uint16_t, kMost> d;
      ForVectors(d, classes_, [&](std::size_t c) { hn::StoreU(hn::Zero(d), d, shares + c); });
      shares[classes_ - 1] = static_cast<std::uint16_t>(whole_);
      return;
    }
    const Wide d;
    const hn::Rebind<std::int16_t, Wide> narrow;
    const hn::Rebind<std::uint16_t, Wide> narrow_shares;
    const hn::Rebind<float, Wide> real;
    const auto most = hn::Set(d, std::max(body, background));
    ForVectors(d, classes_, [&](std::size_t c) {
      const auto below = hn::Sub(most, hn::PromoteTo(d, hn::LoadU(narrow, logits + c)));
      hn::StoreU(hn::GatherIndex(d, powers_, hn::Min(below, hn::Set(d, Powers::kCount))), d, power_.data() + c);
    });
    std::int32_t sum = 0;
    for (const std::int32_t power : power_) sum += power;
    const auto scale = hn::Set(real, float(whole_) / float(sum));
    ForVectors(d, classes_, [&](std::size_t c) {
      const auto share = hn::Mul(hn::ConvertTo(real, hn::LoadU(d, power_.data() + c)), scale);
      const auto rounded = hn::ConvertTo(d, hn::Add(share, hn::Set(real, float(kHalf))));
      hn::StoreU(hn::DemoteTo(narrow_shares, rounded), narrow_shares, shares + c);
    });
  }

 private:
  HWY_INLINE int LargestOfBody(const std::int16_t* HWY_RESTRICT logits) const {
    const Logits d;
    auto most = hn::LoadU(d, logits);
    ForVectors(d, classes_ - 1, [&](std::size_t c) { most = hn::Max(most, hn::LoadU(d, logits + c)); });
    return hn::GetLane(hn::MaxOfLanes(d, most));
  }

  const std::int32_t* powers_ = powers();
  std::size_t classes_;
  int whole_;
  std::vector<std::int32_t> power_;
};

/// Makes posteriors of all pixels of those of every second one. There are at least kMost classes.
template <std::size_t kMost>
class Enlarger {
  using Lanes = hn::CappedTag<std::uint16_t, kMost>;

 public:
  Enlarger(const DepthImage& depth, const Posteriors& half, Posteriors& out)
      : depth_(depth), half_(half), out_(out), classes_(static_cast<std::size_t>(half.classes)) {}

  void Row(int v) const {
    const int below = std::min((v + 1) / 2, half_.height - 1);
    const std::uint8_t *settled = half_.settled.row(v / 2), *settled_below = half_.settled.row(below);
    for (int u = 0; u < depth_.width(); ++u) {
      const int mm = depth_(u, v), left = u / 2, right = std::min((u + 1) / 2, half_.width - 1);
      std::uint16_t* to = out_.at(u, v);
      if (mm == 0) {
        const Lanes d;
        ForVectors(d, classes_, [&](std::size_t c) { hn::StoreU(hn::Zero(d), d, to + c); });
      } else if ((u % 2 == 0 && v % 2 == 0) ||
                 (settled[left] & settled[right] & settled_below[left] & settled_below[right]) != 0) {
        Copy(half_.at(left, v / 2), to);
      } else {
        Mix(u, v, mm, to);
      }
    }
  }

 private:
  HWY_INLINE void Copy(const std::uint16_t* HWY_RESTRICT from, std::uint16_t* HWY_RESTRICT to) const {
    const Lanes d;
    ForVectors(d, classes_, [&](std::size_t c) { hn::StoreU(hn::LoadU(d, from + c), d, to + c); });
  }

  /// Takes the mean of the pixels around whose depth is like this one's; if less than two are, the one that is nearest
  /// to it.
  HWY_INLINE void Mix(int u, int v, int mm, std::uint16_t* HWY_RESTRICT to) const {
    const int like_mm = 20 + 3 * mm / 100;
    const int last_u = std::min((u + 1) / 2, half_.width - 1), last_v = std::min((v + 1) / 2, half_.height - 1);
    std::array<const std::uint16_t*, 4> like{};
    std::size_t count = 0;
    int nearest_mm = 1 << 17;
    const std::uint16_t* nearest = nullptr;
    for (int hv = v / 2; hv <= last_v; ++hv) {
      for (int hu = u / 2; hu <= last_u; ++hu) {
        const int there_mm = depth_(2 * hu, 2 * hv);
        const int off_mm = there_mm == 0 ? 1 << 16 : std::abs(there_mm - mm);
        if (off_mm < like_mm) like[count++] = half_.at(hu, hv);
        if (off_mm < nearest_mm) nearest = half_.at(hu, hv);
        nearest_mm = std::min(nearest_mm, off_mm);
      }
    }
    switch (count) {
      case 4:
        return Mean<4>(like, to);
      case 3:
        return Mean<3>(like, to);
      case 2:
        return Mean<2>(like, to);
      default:
        Copy(nearest, to);
    }
  }

  template <std::size_t kCount>
  HWY_INLINE void Mean(const std::array<const std::uint16_t*, 4>& of, std::uint16_t* HWY_RESTRICT to) const {
    const Lanes d;
    const auto factor = hn::Set(d, static_cast<std::uint16_t>((65536 + kCount - 1) / kCount));
    ForVectors(d, classes_, [&](std::size_t c) {
      auto sum = hn::LoadU(d, of[0] + c);
      for (std::size_t i = 1; i < kCount; ++i) sum = hn::Add(sum, hn::LoadU(d, of[i] + c));
      hn::StoreU(hn::MulHigh(sum, factor), d, to + c);
    });
  }

  const DepthImage& depth_;
  const Posteriors& half_;
  Posteriors& out_;
  std::size_t classes_;
};

constexpr std::size_t kMany = 16;  ///< lanes, so that the classes of the paper's body fill their vectors

void SoftmaxInSteps(const std::int16_t* logits, int pixels, int count, int whole, std::uint16_t* shares) {
  const auto run = [&](auto softmax) {
    for (std::ptrdiff_t i = 0; i < pixels; ++i) softmax.Run(logits + i * count, shares + i * count);
  };
  if (count > int(kMany)) {
    run(Softmax<kMany>(count, whole));
  } else {
    run(Softmax<1>(count, whole));
  }
}

void EnlargeRow(const DepthImage& depth, const Posteriors& half, int v, Posteriors& out) {
  if (half.classes >= int(kMany)) {
    Enlarger<kMany>(depth, half, out).Row(v);
  } else {
    Enlarger<1>(depth, half, out).Row(v);
  }
}

}  // namespace vesalius::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vesalius {

HWY_EXPORT(SoftmaxInSteps);
HWY_EXPORT(EnlargeRow);

void softmax_in_steps(const std::int16_t* logits, int pixels, int count, int whole, std::uint16_t* shares) {
  HWY_DYNAMIC_DISPATCH(SoftmaxInSteps)(logits, pixels, count, whole, shares);
}

void enlarge_row(const DepthImage& depth, const Posteriors& half, int v, Posteriors& out) {
  HWY_DYNAMIC_DISPATCH(EnlargeRow)(depth, half, v, out);
}

}  // namespace vesalius
#endif
