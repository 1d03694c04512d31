#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vesalius/planes/surface_columns.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <cstdint>

#include "vesalius/planes/surface_columns.h"

HWY_BEFORE_NAMESPACE();
namespace vesalius::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Column = SurfaceColumns::Column;
using Query = SurfaceColumns::Query;

/// Areas of samples `i` and those after it that lie on the plane, in whole units; zero for the others. Every step is
/// that of plain code: floats round alike on every instruction set.
template <class D>
HWY_INLINE hn::Vec<hn::RebindToSigned<D>> AreasOn(D d, const SurfaceColumns& samples, std::size_t i, const Query& q) {
  const auto column = [&](Column c) { return hn::LoadU(d, samples.column(c) + i); };
  const auto dot = [&](Column x, Column y, Column z) {
    return hn::Add(hn::Mul(hn::Set(d, q.x), column(x)),
                   hn::Add(hn::Mul(hn::Set(d, q.y), column(y)), hn::Mul(hn::Set(d, q.z), column(z))));
  };
  const auto along = dot(SurfaceColumns::kX, SurfaceColumns::kY, SurfaceColumns::kZ);
  const auto turned = hn::Abs(dot(SurfaceColumns::kNormalX, SurfaceColumns::kNormalY, SurfaceColumns::kNormalZ));
  const auto near = hn::Le(hn::Abs(hn::Sub(along, hn::Set(d, q.offset))), column(SurfaceColumns::kThickness));
  const auto on = hn::And(near, hn::Ge(turned, hn::Set(d, q.aligned)));
  if (hn::AllFalse(d, on)) return hn::Zero(hn::RebindToSigned<D>());
  const auto slant = hn::Max(hn::Div(hn::Abs(along), column(SurfaceColumns::kDistance)), hn::Set(d, q.most_slant));
  const auto units = hn::Div(hn::Mul(column(SurfaceColumns::kArea), hn::Set(d, SurfaceColumns::kUnitsPerM2)), slant);
  return hn::NearestInt(hn::IfThenElseZero(on, hn::Min(units, hn::Set(d, SurfaceColumns::kMostUnits))));
}

std::int64_t SumAreas(const SurfaceColumns& samples, const Query& q) {
  const hn::CappedTag<std::int64_t, 8> wide;
  const hn::Rebind<float, decltype(wide)> d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  auto sums = hn::Zero(wide);
  for (; i + lanes <= samples.size(); i += lanes) {
    sums = hn::Add(sums, hn::PromoteTo(wide, AreasOn(d, samples, i, q)));
  }
  std::int64_t sum = hn::GetLane(hn::SumOfLanes(wide, sums));
  const hn::CappedTag<float, 1> one;
  for (; i < samples.size(); ++i) sum += hn::GetLane(AreasOn(one, samples, i, q));
  return sum;
}

}  // namespace vesalius::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vesalius {

HWY_EXPORT(SumAreas);

void SurfaceColumns::reserve(std::size_t samples) {
  for (std::vector<float>& column : columns_) column.reserve(samples);
}

void SurfaceColumns::add(const Eigen::Vector3f& point, const Eigen::Vector3f& normal, float thickness_m,
                         float area_m2) {
  const float values[] = {point.x(),  point.y(),   point.z(), normal.x(),  normal.y(),
                          normal.z(), thickness_m, area_m2,   point.norm()};
  for (std::size_t c = 0; c < kColumns; ++c) columns_[c].push_back(values[c]);
}

float SurfaceColumns::support(const Eigen::Vector3f& normal, float offset, float aligned, float most_slant) const {
  const std::int64_t units =
      HWY_DYNAMIC_DISPATCH(SumAreas)(*this, {normal.x(), normal.y(), normal.z(), offset, aligned, most_slant});
  return float(units) / kUnitsPerM2;
}

}  // namespace vesalius
#endif
