#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vesalius/choose_kernel.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>

#include "vesalius/choose_kernel.h"
#include "vesalius/image.h"

HWY_BEFORE_NAMESPACE();
namespace vesalius::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Capped, so that the classes of the paper's body fill it; the last vector of a pixel overlaps the one before.
using SumLanes = hn::CappedTag<std::uint16_t, 16>;
using Sums = hn::Vec<SumLanes>;

struct TopTwo {
  std::uint32_t first = 0, second = 0;
  std::size_t best = 0;
};

#if HWY_TARGET == HWY_SCALAR

TopTwo FindTopTwo(const std::uint16_t* sums, std::size_t classes) {
  TopTwo top;
  for (std::size_t c = 0; c < classes; ++c) {
    if (sums[c] > top.first) {
      top = {sums[c], top.first, c};
    } else {
      top.second = std::max<std::uint32_t>(top.second, sums[c]);
    }
  }
  return top;
}

#else

/// Lane by lane the two largest of what was merged.
struct Largest {
  Sums first, second;

  HWY_INLINE void Merge(Sums more_first, Sums more_second) {
    second = hn::Max(hn::Max(second, more_second), hn::Min(first, more_first));
    first = hn::Max(first, more_first);
  }
};

HWY_INLINE TopTwo FindTopTwo(const std::uint16_t* HWY_RESTRICT sums, std::size_t classes) {
  const SumLanes d;
  const std::size_t lanes = hn::Lanes(d);
  const Sums zero = hn::Zero(d);
  Largest all{hn::LoadU(d, sums), zero};
  std::size_t c = lanes;
  for (; c + lanes <= classes; c += lanes) all.Merge(hn::LoadU(d, sums + c), zero);
  const std::size_t last = classes - lanes;
  if (c < classes) {  // what the vector before had counts once
    const auto fresh = hn::Not(hn::FirstN(d, c - last));
    all.Merge(hn::IfThenElseZero(fresh, hn::LoadU(d, sums + last)), zero);
  }
  all.Merge(hn::Reverse2(d, all.first), hn::Reverse2(d, all.second));
  all.Merge(hn::Reverse4(d, all.first), hn::Reverse4(d, all.second));
  all.Merge(hn::Reverse8(d, all.first), hn::Reverse8(d, all.second));
  if (lanes > 8) all.Merge(hn::ReverseBlocks(d, all.first), hn::ReverseBlocks(d, all.second));
  TopTwo top{hn::GetLane(all.first), hn::GetLane(all.second), 0};
  for (c = 0;; c = std::min(c + lanes, last)) {
    const auto found = hn::FindFirstTrue(d, hn::Eq(hn::LoadU(d, sums + c), all.first));
    if (found >= 0) {
      top.best = c + static_cast<std::size_t>(found);
      return top;
    }
  }
}

#endif

void BestClasses(const std::uint16_t* sums, std::size_t stride, int classes, const std::uint8_t* skip, int count,
                 std::uint32_t margin, std::uint8_t* best, std::uint8_t* unsure) {
  for (int i = 0; i < count; ++i, sums += stride) {
    best[i] = kBackground;
    unsure[i] = 0;
    if (skip[i] != 0) continue;
    const TopTwo top = FindTopTwo(sums, static_cast<std::size_t>(classes));
    if (top.first == 0) continue;
    best[i] = static_cast<std::uint8_t>(top.best);
    unsure[i] = top.second > 0 && top.first - top.second < margin ? 1 : 0;
  }
}

std::size_t SumLaneCount() { return hn::Lanes(SumLanes()); }

}  // namespace vesalius::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vesalius {

HWY_EXPORT(BestClasses);
HWY_EXPORT(SumLaneCount);

bool best_classes_fit(int classes) { return classes >= static_cast<int>(HWY_DYNAMIC_DISPATCH(SumLaneCount)()); }

void best_classes(const std::uint16_t* sums, std::size_t stride, int classes, const std::uint8_t* skip, int count,
                  std::uint32_t margin, std::uint8_t* best, std::uint8_t* unsure) {
  HWY_DYNAMIC_DISPATCH(BestClasses)(sums, stride, classes, skip, count, margin, best, unsure);
}

}  // namespace vesalius
#endif
