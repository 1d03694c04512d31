#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vesalius/forest/leaf_logits.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <array>
#include <utility>

#include "vesalius/forest/leaf_logits.h"

HWY_BEFORE_NAMESPACE();
namespace vesalius::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, LogitSoftmax::kLanes>;
using Ints = hn::RebindToSigned<Floats>;
using Shorts = hn::Rebind<std::int16_t, Floats>;
using Bytes = hn::Rebind<std::int8_t, Floats>;
using Float = hn::Vec<Floats>;
using Int = hn::Vec<Ints>;

/// Groups of places: the parts of each side, the background, the headings of each side.
constexpr int kGroups = 7;
constexpr int kBackgroundGroup = 3;
constexpr int kFirstTurn = 4;
/// Powers are summed as integers, so that their order does not matter; 200 parts fit.
constexpr float kFixed = 8388608.F;
constexpr float kAbsent = -1e30F;  ///< logit of a group without places

/// exp of x in [-80, 80] to about 2e-6 of its size: a power of two times a polynomial, by operations that round alike
/// everywhere.
HWY_INLINE Float Exp(Float x) {
  const Floats d;
  const Ints di;
  const Float scaled = hn::Mul(x, hn::Set(d, 1.44269504F));
  const Float whole = hn::Round(scaled);
  const Float rest = hn::Mul(hn::Sub(scaled, whole), hn::Set(d, 0.693147181F));
  Float sum = hn::Set(d, 1.F / 120.F);
  for (const float factor : {1.F / 24.F, 1.F / 6.F, 0.5F, 1.F, 1.F}) {
    sum = hn::Add(hn::Mul(sum, rest), hn::Set(d, factor));
  }
  const Float power = hn::BitCast(d, hn::ShiftLeft<23>(hn::Add(hn::ConvertTo(di, whole), hn::Set(di, 127))));
  return hn::Mul(sum, power);
}

/// Chooses one of kGroups numbers for every place.
HWY_INLINE Float OfGroup(Int group, const float* numbers) {
  const Floats d;
  const Ints di;
  Float chosen = hn::Zero(d);
  for (int g = 0; g < kGroups; ++g) {
    const auto here = hn::RebindMask(d, hn::Eq(group, hn::Set(di, g)));
    chosen = hn::IfThenElse(here, hn::Set(d, numbers[g]), chosen);
  }
  return chosen;
}

/// Each group is taken relative to its own largest logit, so that its sum is exact to 2^-22 of itself.
void Softmax(const std::int32_t* group, std::size_t padded, bool has_turns, float* values) {
  const Floats d;
  const Ints di;
  const std::size_t lanes = hn::Lanes(d);
  const Float low = hn::Set(d, kAbsent);
  Float most[kGroups];
  for (Float& top : most) top = low;
  for (std::size_t i = 0; i < padded; i += lanes) {
    const Int g = hn::LoadU(di, group + i);
    const Float x = hn::LoadU(d, values + i);
    for (int k = 0; k < kGroups; ++k) {
      const auto here = hn::RebindMask(d, hn::Eq(g, hn::Set(di, k)));
      most[k] = hn::Max(most[k], hn::IfThenElse(here, x, low));
    }
  }
  float tops[kGroups];
  for (int k = 0; k < kGroups; ++k) tops[k] = hn::GetLane(hn::MaxOfLanes(d, most[k]));
  Int sums[kGroups];
  for (Int& sum : sums) sum = hn::Zero(di);
  for (std::size_t i = 0; i < padded; i += lanes) {
    const Int g = hn::LoadU(di, group + i);
    const Float x = hn::Max(hn::Sub(hn::LoadU(d, values + i), OfGroup(g, tops)), hn::Set(d, -80.F));
    const auto beyond = hn::RebindMask(d, hn::Eq(g, hn::Set(di, kGroups)));
    const Float power = hn::IfThenZeroElse(beyond, Exp(hn::Min(x, hn::Zero(d))));
    hn::StoreU(power, d, values + i);
    const Int fixed = hn::NearestInt(hn::Mul(power, hn::Set(d, kFixed)));
    for (int k = 0; k < kGroups; ++k) {
      sums[k] = hn::Add(sums[k], hn::IfThenElseZero(hn::Eq(g, hn::Set(di, k)), fixed));
    }
  }
  float sum[kGroups];
  for (int k = 0; k < kGroups; ++k) sum[k] = float(hn::GetLane(hn::SumOfLanes(di, sums[k]))) / kFixed;
  // What each side and the background weigh: their largest logits together, relative to the largest of all.
  float together[LogitSoftmax::kLanes] = {};
  for (int s = 0; s < kSides; ++s) {
    if (!has_turns) sum[kFirstTurn + s] = 1.F;
    together[s] = tops[s] + (has_turns ? tops[kFirstTurn + s] : 0.F);
  }
  together[kBackgroundGroup] = tops[kBackgroundGroup];
  const float top = std::max(std::max(together[0], together[1]), std::max(together[2], together[3]));
  for (int k = 0; k <= kBackgroundGroup; ++k) together[k] = std::max(together[k] - top, -80.F);
  for (std::size_t i = 0; i < LogitSoftmax::kLanes; i += lanes) {
    hn::StoreU(Exp(hn::LoadU(d, together + i)), d, together + i);
  }
  float all = together[kBackgroundGroup] * sum[kBackgroundGroup];
  for (int s = 0; s < kSides; ++s) all += together[s] * sum[s] * sum[kFirstTurn + s];
  float scales[kGroups];
  scales[kBackgroundGroup] = together[kBackgroundGroup] / all;
  for (int s = 0; s < kSides; ++s) {
    scales[s] = together[s] * sum[kFirstTurn + s] / all;
    scales[kFirstTurn + s] = together[s] * sum[s] / all;
  }
  for (std::size_t i = 0; i < padded; i += lanes) {
    const Int g = hn::LoadU(di, group + i);
    hn::StoreU(hn::Mul(hn::LoadU(d, values + i), OfGroup(g, scales)), d, values + i);
  }
}

/// Sets values to the sums over the leaves times `unit`.
void SumLeaves(const std::int8_t* const* leaves, std::size_t count, std::size_t padded, float unit, float* values) {
  const Floats d;
  const Ints di;
  const Shorts ds;
  const Bytes db;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t i = 0; i < padded; i += lanes) {
    auto sum = hn::Zero(ds);
    for (std::size_t t = 0; t < count; ++t) sum = hn::Add(sum, hn::PromoteTo(ds, hn::LoadU(db, leaves[t] + i)));
    hn::StoreU(hn::Mul(hn::ConvertTo(d, hn::PromoteTo(di, sum)), hn::Set(d, unit)), d, values + i);
  }
}

}  // namespace vesalius::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vesalius {

HWY_EXPORT(Softmax);
HWY_EXPORT(SumLeaves);

LogitLayout::LogitLayout(const BodyModel& body, bool has_background, int heading_count)
    : parts(body.part_count()), background(has_background), headings(heading_count) {
  for (int p = 0; p < parts; ++p) {
    const bool middle = body.parts[p].mirror == p;
    side.push_back(middle ? 0 : body.parts[p].name.starts_with("l_") ? 1 : 2);
  }
}

LogitSoftmax::LogitSoftmax(LogitLayout layout) : layout_(std::move(layout)) {
  for (const std::uint8_t s : layout_.side) group_.push_back(s);
  if (layout_.background) group_.push_back(kSides);
  for (int s = 0; s < kSides; ++s) group_.insert(group_.end(), layout_.headings, kSides + 1 + s);
  group_.resize((group_.size() + kLanes - 1) / kLanes * kLanes, 2 * kSides + 1);
}

void LogitSoftmax::operator()(float* values) const {
  HWY_DYNAMIC_DISPATCH(Softmax)(group_.data(), padded(), layout_.headings > 0, values);
}

LogitReader::LogitReader(const LogitLayout& layout, float unit, int trees)
    : softmax_(layout),
      unit_(unit),
      trees_(static_cast<std::size_t>(trees)),
      whole_(255.F * float(trees)),
      shares_(softmax_.padded()) {}

void LogitReader::read(const std::int8_t* const* leaves, std::uint16_t* posteriors, std::uint16_t* turns) {
  HWY_DYNAMIC_DISPATCH(SumLeaves)(leaves, trees_, padded(), unit_, shares_.data());
  softmax_(shares_.data());
  const LogitLayout& layout = softmax_.layout();
  for (int c = 0; c < layout.classes(); ++c) posteriors[c] = static_cast<std::uint16_t>(shares_[c] * whole_ + 0.5F);
  const float* of_turns = shares_.data() + layout.classes();
  const int count = kSides * layout.headings;
  float body = 1e-30F;
  for (int i = 0; i < count; ++i) body += of_turns[i];
  const float scale = 65535.F / body;
  for (int i = 0; i < count; ++i) {
    turns[i] = static_cast<std::uint16_t>(std::min(of_turns[i] * scale + 0.5F, 65535.F));
  }
}

}  // namespace vesalius
#endif
