#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vesalius/planes/surface_columns.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <cmath>

#include "vesalius/planes/surface_columns.h"

HWY_BEFORE_NAMESPACE();
namespace vesalius::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Wide = hn::CappedTag<double, 8>;
using Floats = hn::Rebind<float, Wide>;
using Column = SurfaceColumns::Column;

using Query = SurfaceColumns::Query;

/// Areas of samples `i` and those after it that lie on the plane, zero for the others. Every step is that of the plain
/// code, in its order: floats round alike.
template <class D>
HWY_INLINE hn::Vec<D> AreasOn(D d, const SurfaceColumns& samples, std::size_t i, const Query& q) {
  const auto column = [&](Column c) { return hn::LoadU(d, samples.column(c) + i); };
  const auto dot = [&](Column x, Column y, Column z) {
    return hn::Add(hn::Mul(hn::Set(d, q.x), column(x)),
                   hn::Add(hn::Mul(hn::Set(d, q.y), column(y)), hn::Mul(hn::Set(d, q.z), column(z))));
  };
  const auto along = dot(SurfaceColumns::kX, SurfaceColumns::kY, SurfaceColumns::kZ);
  const auto turned = hn::Abs(dot(SurfaceColumns::kNormalX, SurfaceColumns::kNormalY, SurfaceColumns::kNormalZ));
  const auto near = hn::Le(hn::Abs(hn::Sub(along, hn::Set(d, q.offset))), column(SurfaceColumns::kThickness));
  const auto on = hn::And(near, hn::Ge(turned, hn::Set(d, q.aligned)));
  if (hn::AllFalse(d, on)) return hn::Zero(d);
  const auto slant = hn::Div(hn::Abs(along), column(SurfaceColumns::kDistance));
  return hn::IfThenElseZero(on, hn::Div(column(SurfaceColumns::kArea), hn::Max(slant, hn::Set(d, q.most_slant))));
}

double SumAreas(const SurfaceColumns& samples, const Query& q, bool any_order) {
  const Wide wide;
  const Floats d;
  const std::size_t lanes = hn::Lanes(d);
  std::size_t i = 0;
  double sum = 0.0;
  if (any_order) {
    auto sums = hn::Zero(wide);
    for (; i + lanes <= samples.size(); i += lanes) {
      sums = hn::Add(sums, hn::PromoteTo(wide, AreasOn(d, samples, i, q)));
    }
    HWY_ALIGN double each[HWY_MAX_BYTES / sizeof(double)];
    hn::Store(sums, wide, each);
    for (std::size_t lane = 0; lane < lanes; ++lane) sum += each[lane];
  }
  const hn::CappedTag<float, 1> one;
  for (; i < samples.size(); ++i) sum += static_cast<double>(hn::GetLane(AreasOn(one, samples, i, q)));
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
  smallest_ = std::min(smallest_, area_m2);
  total_ += static_cast<double>(area_m2);
}

bool SurfaceColumns::sums_are_exact(float most_slant) const {
  if (size() == 0 || !(smallest_ > 0.F) || !std::isfinite(total_)) return false;
  // A float holds 24 bits from its highest down, a double 53; one bit more at either end for what is rounded here.
  const double largest_sum = 2.0 * total_ / static_cast<double>(most_slant);
  return std::ilogb(largest_sum) - (std::ilogb(smallest_) - 1 - 23) < 53;
}

float SurfaceColumns::support(const Eigen::Vector3f& normal, float offset, float aligned, float most_slant) const {
  return static_cast<float>(HWY_DYNAMIC_DISPATCH(SumAreas)(
      *this, {normal.x(), normal.y(), normal.z(), offset, aligned, most_slant}, sums_are_exact(most_slant)));
}

}  // namespace vesalius
#endif
