#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vesalius/row_kernels.cpp"
#include <hwy/foreach_target.h>  // must come before highway.h
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>

#include "vesalius/row_kernels.h"

#ifndef VESALIUS_ROW_KERNELS
#define VESALIUS_ROW_KERNELS
namespace vesalius {
namespace {

/// A ball, seen from a row of pixels.
struct Ball {
  float cx, fx;     ///< of the camera
  float y_per_m;    ///< of the row's points a metre away
  float x, y, z;    ///< the middle, m
  float square_m2;  ///< of its radius
};

}  // namespace
}  // namespace vesalius
#endif

HWY_BEFORE_NAMESPACE();
namespace vesalius::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE std::int32_t SumOf(const std::uint16_t* numbers, std::size_t count) {
  return std::accumulate(numbers, numbers + count, 0);
}

#else

// Capped, so that the parts of the paper's body fill it.
HWY_INLINE std::int32_t SumOf(const std::uint16_t* HWY_RESTRICT numbers, std::size_t count) {
  const hn::CappedTag<std::uint16_t, 16> d;
  const hn::Repartition<std::uint32_t, decltype(d)> wide;
  const std::size_t lanes = hn::Lanes(d);
  if (count < lanes) return std::accumulate(numbers, numbers + count, 0);
  auto sums = hn::Zero(wide);
  const auto add = [&](auto some) {
    const auto pairs = hn::BitCast(wide, some);
    sums = hn::Add(sums, hn::Add(hn::And(pairs, hn::Set(wide, 0xFFFF)), hn::ShiftRight<16>(pairs)));
  };
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) add(hn::LoadU(d, numbers + i));
  const std::size_t last = count - lanes;
  if (i < count) add(hn::IfThenElseZero(hn::Not(hn::FirstN(d, i - last)), hn::LoadU(d, numbers + last)));
  return static_cast<std::int32_t>(hn::GetLane(hn::SumOfLanes(wide, sums)));
}

#endif

constexpr int kDarkest = 24;              // brightest channel below which a hue means nothing
constexpr float kLeastSaturation = 0.2F;  // the same

/// Red, green and blue of as many colours as there are lanes.
template <class D>
HWY_INLINE hn::Vec<D> HuesOf(D d, hn::Vec<D> r, hn::Vec<D> g, hn::Vec<D> b, int hues) {
  const hn::Rebind<float, D> real;
  const auto high = hn::Max(hn::Max(r, g), b), span = hn::Sub(high, hn::Min(hn::Min(r, g), b));
  const auto least = hn::Mul(hn::Set(real, kLeastSaturation), hn::ConvertTo(real, high));
  const auto is_grey =
      hn::Or(hn::Lt(high, hn::Set(d, kDarkest)), hn::RebindMask(d, hn::Lt(hn::ConvertTo(real, span), least)));
  const auto all = hn::Set(d, hues);
  const auto grey = hn::Add(all, hn::ShiftRight<3>(high));
  // The position on the colour circle, in sixths.
  const auto wide = hn::ConvertTo(real, hn::Max(span, hn::Set(d, 1)));
  const auto share = [&](auto of, auto less) { return hn::Div(hn::ConvertTo(real, hn::Sub(of, less)), wide); };
  const auto of_blue = hn::Add(hn::Set(real, 4.F), share(r, g));
  const auto of_green = hn::Add(hn::Set(real, 2.F), share(b, r));
  const auto no_red = hn::IfThenElse(hn::RebindMask(real, hn::Eq(high, g)), of_green, of_blue);
  const auto sixth = hn::IfThenElse(hn::RebindMask(real, hn::Eq(high, r)), share(g, b), no_red);
  const auto steps = hn::Div(hn::Mul(sixth, hn::Set(real, float(hues))), hn::Set(real, 6.F));
  const auto hue = hn::ConvertTo(d, hn::Floor(hn::Add(steps, hn::Set(real, 0.5F))));
  return hn::IfThenElse(is_grey, grey, hn::IfThenElse(hn::Lt(hue, hn::Zero(d)), hn::Add(hue, all), hue));
}

template <class D>
HWY_INLINE void ClassifySome(D d, const std::uint8_t* r, const std::uint8_t* g, const std::uint8_t* b, int hues,
                             std::uint16_t* classes) {
  const auto some = [&](const std::uint8_t* of) {
    return hn::PromoteTo(d, hn::LoadU(hn::Rebind<std::uint8_t, D>(), of));
  };
  const hn::Rebind<std::uint16_t, D> out;
  hn::StoreU(hn::DemoteTo(out, HuesOf(d, some(r), some(g), some(b), hues)), out, classes);
}

void ClassifyHues(const Rgb* colours, int count, int hues, std::uint16_t* classes) {
  int i = 0;
#if HWY_TARGET != HWY_SCALAR
  constexpr std::size_t kAtOnce = 16;
  const hn::FixedTag<std::uint8_t, kAtOnce> bytes;
  const hn::CappedTag<std::int32_t, kAtOnce> d;
  std::array<std::uint8_t, kAtOnce> red, green, blue;
  for (; i + int(kAtOnce) <= count; i += int(kAtOnce)) {
    auto r = hn::Zero(bytes), g = r, b = r;
    hn::LoadInterleaved3(bytes, &colours[i].r, r, g, b);
    hn::StoreU(r, bytes, red.data());
    hn::StoreU(g, bytes, green.data());
    hn::StoreU(b, bytes, blue.data());
    for (std::size_t k = 0; k < kAtOnce; k += hn::Lanes(d)) {
      ClassifySome(d, red.data() + k, green.data() + k, blue.data() + k, hues, classes + i + k);
    }
  }
#endif
  const hn::CappedTag<std::int32_t, 1> one;
  for (; i < count; ++i) ClassifySome(one, &colours[i].r, &colours[i].g, &colours[i].b, hues, classes + i);
}

void SumBodies(const std::uint16_t* posteriors, std::size_t classes, std::size_t parts, const std::uint8_t* skip,
               int count, BodySums* sums) {
  for (int i = 0; i < count; ++i, posteriors += classes) {
    sums[i] = {};
    if (skip[i] != 0) continue;
    sums[i].body = SumOf(posteriors, parts);
    sums[i].all = std::accumulate(posteriors + parts, posteriors + classes, sums[i].body);
  }
}

/// Every step is that of (point_at(...) - point).squaredNorm().
template <class Lanes>
HWY_INLINE void MarkSome(Lanes d, const std::uint16_t* depth, int u, const Ball& ball, std::uint8_t* mask) {
  const hn::Rebind<float, Lanes> real;
  const hn::Rebind<std::uint8_t, Lanes> bytes;
  const auto mm = hn::PromoteTo(d, hn::LoadU(hn::Rebind<std::uint16_t, Lanes>(), depth));
  const auto z = hn::Mul(hn::ConvertTo(real, mm), hn::Set(real, 1e-3F));
  const auto off_z = hn::Sub(z, hn::Set(real, ball.z));
  const auto square = hn::Set(real, ball.square_m2);
  const auto square_z = hn::Mul(off_z, off_z);
  if (hn::AllFalse(real, hn::Le(square_z, square))) return;
  const auto column = hn::ConvertTo(real, hn::Iota(d, u));
  const auto x = hn::Mul(hn::Div(hn::Sub(column, hn::Set(real, ball.cx)), hn::Set(real, ball.fx)), z);
  const auto off_x = hn::Sub(x, hn::Set(real, ball.x));
  const auto off_y = hn::Sub(hn::Mul(hn::Set(real, ball.y_per_m), z), hn::Set(real, ball.y));
  const auto distance = hn::Add(hn::Mul(off_x, off_x), hn::Add(hn::Mul(off_y, off_y), square_z));
  const auto near = hn::And(hn::RebindMask(d, hn::Le(distance, square)), hn::Ne(mm, hn::Zero(d)));
  const auto ones = hn::DemoteTo(bytes, hn::IfThenElseZero(near, hn::Set(d, 1)));
  hn::StoreU(hn::Or(hn::LoadU(bytes, mask), ones), bytes, mask);
}

/// `depth` and `mask` begin at column `u`.
void MarkNear(const std::uint16_t* depth, int u, int count, const Ball& ball, std::uint8_t* mask) {
  const hn::ScalableTag<std::int32_t> many;
  const hn::CappedTag<std::int32_t, 1> one;
  const int lanes = int(hn::Lanes(many));
  int i = 0;
  for (; i + lanes <= count; i += lanes) MarkSome(many, depth + i, u + i, ball, mask + i);
  for (; i < count; ++i) MarkSome(one, depth + i, u + i, ball, mask + i);
}

constexpr float kLeastSquare_m2 = 1e-8F;  // of a capsule's axis, as Capsule::distance has it

/// Every step is that of Capsule::distance.
template <class D>
HWY_INLINE void ComeNearer(D d, const PointRow& points, std::size_t i, const Capsule& capsule, float nearest_m,
                           float farthest_m, float reach_m, float* distance) {
  const auto of = [&](float number) { return hn::Set(d, number); };
  const auto z = hn::LoadU(d, points.z.data() + i);
  const auto there = hn::And(hn::And(hn::Ge(z, of(nearest_m)), hn::Le(z, of(farthest_m))), hn::Ne(z, of(0.F)));
  if (hn::AllFalse(d, there)) return;
  const Eigen::Vector3f axis = capsule.to - capsule.from;
  const auto dot = [](auto ax, auto ay, auto az, auto bx, auto by, auto bz) {
    return hn::Add(hn::Mul(ax, bx), hn::Add(hn::Mul(ay, by), hn::Mul(az, bz)));
  };
  const auto x = hn::Sub(hn::LoadU(d, points.x.data() + i), of(capsule.from.x()));
  const auto y = hn::Sub(hn::LoadU(d, points.y.data() + i), of(capsule.from.y()));
  const auto off_z = hn::Sub(z, of(capsule.from.z()));
  const auto share = hn::Div(dot(x, y, off_z, of(axis.x()), of(axis.y()), of(axis.z())),
                             of(std::max(axis.squaredNorm(), kLeastSquare_m2)));
  const auto along = hn::Min(hn::Max(share, of(0.F)), of(1.F));
  const auto rx = hn::Sub(x, hn::Mul(along, of(axis.x()))), ry = hn::Sub(y, hn::Mul(along, of(axis.y())));
  const auto rz = hn::Sub(off_z, hn::Mul(along, of(axis.z())));
  const auto radius = hn::Add(of(capsule.from_radius), hn::Mul(along, of(capsule.to_radius - capsule.from_radius)));
  const auto outside = hn::Sub(hn::Sqrt(dot(rx, ry, rz, rx, ry, rz)), radius);
  const auto before = hn::LoadU(d, distance + i);
  const auto nearer = hn::And(there, hn::Lt(outside, of(reach_m)));
  hn::StoreU(hn::IfThenElse(nearer, hn::Min(before, outside), before), d, distance + i);
}

void LowerDistances(const PointRow& points, std::size_t begin, std::size_t end, const Capsule& capsule, float nearest_m,
                    float farthest_m, float reach_m, float* distance) {
  const hn::ScalableTag<float> many;
  const hn::CappedTag<float, 1> one;
  std::size_t i = begin;
  for (; i + hn::Lanes(many) <= end; i += hn::Lanes(many)) {
    ComeNearer(many, points, i, capsule, nearest_m, farthest_m, reach_m, distance);
  }
  for (; i < end; ++i) ComeNearer(one, points, i, capsule, nearest_m, farthest_m, reach_m, distance);
}

}  // namespace vesalius::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vesalius {

HWY_EXPORT(ClassifyHues);
HWY_EXPORT(LowerDistances);
HWY_EXPORT(MarkNear);
HWY_EXPORT(SumBodies);

void sum_bodies(const Posteriors& posteriors, int u, int v, int parts, const std::uint8_t* skip, int count,
                BodySums* sums) {
  HWY_DYNAMIC_DISPATCH(SumBodies)
  (posteriors.at(u, v), static_cast<std::size_t>(posteriors.classes), static_cast<std::size_t>(parts), skip, count,
   sums);
}

void mark_near(const DepthImage& depth, const Camera& camera, const Eigen::Vector3f& point, float radius_m,
               const Box& box, Mask& mask) {
  Ball ball{camera.cx, camera.fx, 0.F, point.x(), point.y(), point.z(), radius_m * radius_m};
  for (int v = box.v; v < box.v + box.height; ++v) {
    ball.y_per_m = (float(v) - camera.cy) / camera.fy;
    HWY_DYNAMIC_DISPATCH(MarkNear)(depth.row(v) + box.u, box.u, box.width, ball, mask.row(v) + box.u);
  }
}

void lower_distances(const PointRow& points, std::size_t begin, std::size_t end, const Capsule& capsule,
                     float nearest_m, float farthest_m, float reach_m, float* distance) {
  HWY_DYNAMIC_DISPATCH(LowerDistances)(points, begin, end, capsule, nearest_m, farthest_m, reach_m, distance);
}

void classify_hues(const Rgb* colours, int count, int hues, std::uint16_t* classes) {
  HWY_DYNAMIC_DISPATCH(ClassifyHues)(colours, count, hues, classes);
}

}  // namespace vesalius
#endif
