#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vesalius/forest/top_two.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>

#include "vesalius/forest/top_two.h"
#include "vesalius/image.h"

HWY_BEFORE_NAMESPACE();
namespace vesalius::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Capped, so that the classes of the paper's body fill it; the last vector of a pixel overlaps the one before.
using SumLanes = hn::CappedTag<std::uint16_t, 16>;
using Sums = hn::Vec<SumLanes>;

/// Class by class: for few of them, or where there are no vectors.
TopTwo PlainTopTwo(const std::uint16_t* sums, std::size_t classes) {
  TopTwo top;
  for (std::size_t c = 0; c < classes; ++c) {
    if (sums[c] > top.first) {
      top = {sums[c], top.first, static_cast<std::uint16_t>(c)};
    } else {
      top.second = std::max(top.second, sums[c]);
    }
  }
  return top;
}

#if HWY_TARGET == HWY_SCALAR

TopTwo FindTopTwo(const std::uint16_t* sums, std::size_t classes) { return PlainTopTwo(sums, classes); }

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
  if (classes < lanes) return PlainTopTwo(sums, classes);
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
      top.best = static_cast<std::uint16_t>(c + static_cast<std::size_t>(found));
      return top;
    }
  }
}

#endif

void FindTopTwoOfRow(const std::uint16_t* sums, std::size_t stride, int classes, const std::uint8_t* skip, int count,
                     TopTwo* top) {
  for (int i = 0; i < count; ++i, sums += stride) {
    top[i] = skip[i] != 0 ? TopTwo{} : FindTopTwo(sums, static_cast<std::size_t>(classes));
  }
}

}  // namespace vesalius::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vesalius {

HWY_EXPORT(FindTopTwoOfRow);

void find_top_two(const std::uint16_t* sums, std::size_t stride, int classes, const std::uint8_t* skip, int count,
                  TopTwo* top) {
  HWY_DYNAMIC_DISPATCH(FindTopTwoOfRow)(sums, stride, classes, skip, count, top);
}

}  // namespace vesalius
#endif
