#include "capsule/capsule_shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vesalius {
namespace {

using Eigen::Vector3d;

/// Returns where a ray enters the unit sphere around (0, y, 0); NaN if it misses.
double enter_sphere(const Vector3d& origin, const Vector3d& direction, double y) {
  const Vector3d o(origin.x(), origin.y() - y, origin.z());
  const double a = direction.squaredNorm();
  const double b = o.dot(direction);
  return (-b - std::sqrt(b * b - a * (o.squaredNorm() - 1.0))) / a;
}

/// Returns where a ray enters the unit capsule; NaN if it misses.
double enter_capsule(const Vector3d& o, const Vector3d& d, double half_length) {
  const double a = d.x() * d.x() + d.z() * d.z();
  const double b = o.x() * d.x() + o.z() * d.z();
  const double c = o.x() * o.x() + o.z() * o.z() - 1.0;
  // A ray along the axis can only hit an end first.
  if (a <= 1e-14 * d.squaredNorm()) return enter_sphere(o, d, d.y() > 0.0 ? -half_length : half_length);
  const double t = (-b - std::sqrt(b * b - a * c)) / a;
  const double y = o.y() + t * d.y();
  if (std::isnan(t) || std::abs(y) <= half_length) return t;
  return enter_sphere(o, d, y > 0.0 ? half_length : -half_length);
}

}  // namespace

std::optional<ShapeHit> intersect(const CapsuleShape& shape, const Vector3d& origin, const Vector3d& direction) {
  const Vector3d o = (shape.world_from_shape.transpose() * (origin - shape.centre_m)).cwiseQuotient(shape.scale_m);
  const Vector3d d = (shape.world_from_shape.transpose() * direction).cwiseQuotient(shape.scale_m);
  const double t = enter_capsule(o, d, shape.half_length);
  if (!(t > 0.0)) return std::nullopt;
  return ShapeHit{t, o + t * d};
}

Vector3d normal(const CapsuleShape& shape, const Vector3d& local) {
  const double on_axis = std::clamp(local.y(), -shape.half_length, shape.half_length);
  const Vector3d n(local.x(), local.y() - on_axis, local.z());
  return (shape.world_from_shape * n.cwiseQuotient(shape.scale_m)).normalized();
}

Slab measure_slab(const CapsuleShape& shape, double low, double high) {
  constexpr int kSteps = 200;
  const double end = shape.half_length + 1.0;
  low = std::clamp(low, -end, end);
  high = std::clamp(high, -end, end);
  const double step = (high - low) / kSteps;
  double area = 0.0, area_y = 0.0, area_x = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double y = low + (i + 0.5) * step;
    const double beyond = std::max(0.0, std::abs(y) - shape.half_length);
    const double radius2 = 1.0 - beyond * beyond;
    const double half_disc = 0.5 * std::numbers::pi * radius2;
    area += half_disc;
    area_y += half_disc * y;
    area_x += 2.0 / 3.0 * radius2 * std::sqrt(radius2);
  }
  if (!(area * step > 0.0)) return {};
  return {area * step * shape.scale_m.prod(), area_y / area, area_x / area};
}

}  // namespace vesalius
