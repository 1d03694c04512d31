#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "train/feature_rows.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include "train/feature_rows.h"

HWY_BEFORE_NAMESPACE();
namespace vesalius::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<std::int32_t, CandidateTable::kLanes>;
using Int32 = hn::Vec<Lanes>;

/// Reads depth around one sample; the constants of a frame, a camera and a pixel in registers.
class Prober {
 public:
  Prober(const FrameStore::View& view, const FeatureConvention& convention, const TrainingSample& sample)
      : tiles_(view.tiles), scale_(view.scaler.at(sample.depth_mm)) {
    const Lanes d;
    u_ = hn::Set(d, sample.u);
    v_ = hn::Set(d, sample.v);
    width_ = hn::Set(d, view.width);
    height_ = hn::Set(d, view.height);
    per_row_ = hn::Set(d, view.tiles_per_row);
    hole_ = hn::Set(d, convention.hole_mm);
    outside_ = hn::Set(d, convention.outside_mm);
    const std::int32_t clip = convention.clip_mm != 0 ? convention.clip_mm : 65536;
    low_ = hn::Set(d, sample.depth_mm - clip);
    high_ = hn::Set(d, sample.depth_mm + clip);
  }

  Int32 operator()(Int32 du, Int32 dv) const {
    const Lanes d;
    const Int32 half = hn::Set(d, 32768);
    const Int32 u = hn::Add(u_, hn::ShiftRight<16>(hn::Add(hn::Mul(du, hn::Set(d, scale_.u)), half)));
    const Int32 v = hn::Add(v_, hn::ShiftRight<16>(hn::Add(hn::Mul(dv, hn::Set(d, scale_.v)), half)));
    const Int32 zero = hn::Zero(d);
    const Int32 before = hn::Set(d, -1);
    const auto inside =
        hn::And(hn::And(hn::Gt(u, before), hn::Lt(u, width_)), hn::And(hn::Gt(v, before), hn::Lt(v, height_)));
    const Int32 tile = hn::Add(hn::Mul(hn::ShiftRight<2>(v), per_row_), hn::ShiftRight<3>(u));
    const Int32 in_tile = hn::Add(hn::ShiftLeft<3>(hn::And(v, hn::Set(d, 3))), hn::And(u, hn::Set(d, 7)));
    const Int32 at = hn::ShiftLeft<1>(hn::Add(hn::ShiftLeft<5>(tile), in_tile));
    // Two bytes more than needed are read; the store keeps that much beyond its last frame.
    const Int32 read =
        hn::And(hn::GatherOffset(d, reinterpret_cast<const std::int32_t*>(tiles_), hn::IfThenElseZero(inside, at)),
                hn::Set(d, 0xFFFF));
    const Int32 seen = hn::IfThenElse(hn::Eq(read, zero), hole_, read);
    return hn::Min(hn::Max(hn::IfThenElse(inside, seen, outside_), low_), high_);
  }

 private:
  const std::uint16_t* tiles_;
  OffsetScale scale_;
  Int32 u_, v_, width_, height_, per_row_, hole_, outside_, low_, high_;
};

void EvaluateCandidates(const FrameStore::View& view, const FeatureConvention& convention, const TrainingSample& sample,
                        const std::int16_t* HWY_RESTRICT du1, int padded, std::int16_t* HWY_RESTRICT values) {
  const Lanes d;
  const hn::Rebind<std::int16_t, Lanes> narrow;
  const Prober probe(view, convention, sample);
  const std::int16_t* HWY_RESTRICT dv1 = du1 + padded;
  const std::int16_t* HWY_RESTRICT du2 = dv1 + padded;
  const std::int16_t* HWY_RESTRICT dv2 = du2 + padded;
  const auto load = [&](const std::int16_t* from) { return hn::PromoteTo(d, hn::LoadU(narrow, from)); };
  for (int i = 0; i < padded; i += static_cast<int>(hn::Lanes(d))) {
    const Int32 first = probe(load(du1 + i), load(dv1 + i));
    const Int32 second = probe(load(du2 + i), load(dv2 + i));
    hn::StoreU(hn::DemoteTo(narrow, hn::Sub(first, second)), narrow, values + i);
  }
}

}  // namespace vesalius::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vesalius {

HWY_EXPORT(EvaluateCandidates);

void evaluate_candidates(const FrameStore::View& view, const FeatureConvention& convention,
                         const TrainingSample& sample, const std::int16_t* offsets, int padded, std::int16_t* values) {
  HWY_DYNAMIC_DISPATCH(EvaluateCandidates)(view, convention, sample, offsets, padded, values);
}

}  // namespace vesalius
#endif
