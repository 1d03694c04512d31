#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "train/feature_rows.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include "train/feature_rows.h"
#include "train/messages/training_messages.h"
#include "train/samples/walk_samples.h"
#include "train/split_candidates.h"

HWY_BEFORE_NAMESPACE();
namespace vesalius::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<std::int32_t, CandidateTable::kLanes>;
using ULanes = hn::RebindToUnsigned<Lanes>;
using Int32 = hn::Vec<Lanes>;

/// Computes where the probes of one sample read. The constants of a frame, a camera and a pixel are in registers.
class Placer {
 public:
  Placer(const TiledDepth& depth, const TrainingSample& sample) : scale_(depth.scaler.at(sample.depth_mm)) {
    const Lanes d;
    u_ = hn::Set(d, sample.u);
    v_ = hn::Set(d, sample.v);
    last_u_ = hn::Set(ULanes(), static_cast<std::uint32_t>(depth.grid.width - 1));
    last_v_ = hn::Set(ULanes(), static_cast<std::uint32_t>(depth.grid.height - 1));
    row_pixels_ = hn::Set(d, depth.grid.per_row() * TileGrid::kPixels);
    outside_ = hn::Set(d, static_cast<std::int32_t>(depth.grid.tiles() * TileGrid::kPixels));
  }

  /// Returns an index in TiledDepth::tiles.
  HWY_INLINE Int32 operator()(Int32 du, Int32 dv) const {
    const Lanes d;
    const Int32 half = hn::Set(d, 32768);
    const Int32 u = hn::Add(u_, hn::ShiftRight<16>(hn::Add(hn::Mul(du, hn::Set(d, scale_.u)), half)));
    const Int32 v = hn::Add(v_, hn::ShiftRight<16>(hn::Add(hn::Mul(dv, hn::Set(d, scale_.v)), half)));
    const auto inside = hn::And(UpTo(u, last_u_), UpTo(v, last_v_));
    static_assert(TileGrid::kWidth == 8 && TileGrid::kHeight == 4);
    const Int32 in_tile = hn::Add(hn::ShiftLeft<3>(hn::And(v, hn::Set(d, 3))), hn::And(u, hn::Set(d, 7)));
    const Int32 tile = hn::Add(hn::Mul(hn::ShiftRight<2>(v), row_pixels_), hn::ShiftLeft<5>(hn::ShiftRight<3>(u)));
    return hn::IfThenElse(inside, hn::Add(tile, in_tile), outside_);
  }

 private:
  /// Returns whether 0 <= x <= last.
  static HWY_INLINE hn::Mask<Lanes> UpTo(Int32 x, hn::Vec<ULanes> last) {
    const auto unsigned_x = hn::BitCast(ULanes(), x);
    return hn::RebindMask(Lanes(), hn::Eq(hn::Min(unsigned_x, last), unsigned_x));
  }

  OffsetScale scale_;
  Int32 u_, v_, row_pixels_, outside_;
  hn::Vec<ULanes> last_u_, last_v_;
};

// Values are loaded one by one, because a gather takes longer (docs/performance.md).
void EvaluateCandidates(const TiledDepth& depth, const FeatureConvention& convention, const TrainingSample& sample,
                        const std::int16_t* HWY_RESTRICT du1, int padded, std::int16_t* HWY_RESTRICT values) {
  const Lanes d;
  const hn::Rebind<std::int16_t, Lanes> narrow;
  const Placer place(depth, sample);
  const auto count = static_cast<std::size_t>(padded);
  const std::int16_t* HWY_RESTRICT dv1 = du1 + count;
  const std::int16_t* HWY_RESTRICT du2 = dv1 + count;
  const std::int16_t* HWY_RESTRICT dv2 = du2 + count;
  alignas(64) std::int32_t first_at[kBlockCandidates];
  alignas(64) std::int32_t second_at[kBlockCandidates];
  const auto load = [&](const std::int16_t* from) { return hn::PromoteTo(d, hn::LoadU(narrow, from)); };
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    hn::Store(place(load(du1 + i), load(dv1 + i)), d, first_at + i);
    hn::Store(place(load(du2 + i), load(dv2 + i)), d, second_at + i);
  }
  alignas(64) std::uint32_t read[kBlockCandidates];  // the first probe's value is in the low half
  const std::uint16_t* HWY_RESTRICT tiles = depth.tiles;
  for (std::size_t i = 0; i < count; ++i) {
    read[i] = tiles[first_at[i]] | static_cast<std::uint32_t>(tiles[second_at[i]]) << 16U;
  }
  const std::int32_t clip = convention.clip_mm != 0 ? convention.clip_mm : 65536;
  const Int32 low = hn::Set(d, sample.depth_mm - clip);
  const Int32 high = hn::Set(d, sample.depth_mm + clip);
  const auto clipped = [&](hn::Vec<ULanes> mm) { return hn::Min(hn::Max(hn::BitCast(d, mm), low), high); };
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto both = hn::Load(ULanes(), read + i);
    const Int32 first = clipped(hn::And(both, hn::Set(ULanes(), 0xFFFF)));
    const Int32 second = clipped(hn::ShiftRight<16>(both));
    hn::StoreU(hn::DemoteTo(narrow, hn::Sub(first, second)), narrow, values + i);
  }
}

}  // namespace vesalius::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <algorithm>
#include <limits>

namespace vesalius {

HWY_EXPORT(EvaluateCandidates);

void evaluate_candidates(const TiledDepth& depth, const FeatureConvention& convention, const TrainingSample& sample,
                         const std::int16_t* offsets, int padded, std::int16_t* values) {
  HWY_DYNAMIC_DISPATCH(EvaluateCandidates)(depth, convention, sample, offsets, padded, values);
}

void evaluate_candidates(const FrameStore::View& view, const FeatureConvention& convention,
                         const TrainingSample& sample, const std::int16_t* offsets, int padded, std::int16_t* values) {
  using Limits = std::numeric_limits<std::int16_t>;
  const std::int16_t* at = offsets;
  for (int i = 0; i < padded; ++i, ++at) {
    const TreeNode node{.du1 = at[0], .dv1 = at[padded], .du2 = at[2 * padded], .dv2 = at[3 * padded]};
    const int value = feature_of(view, convention, sample, node);
    values[i] = static_cast<std::int16_t>(std::clamp<int>(value, Limits::min(), Limits::max()));
  }
}

}  // namespace vesalius
#endif
