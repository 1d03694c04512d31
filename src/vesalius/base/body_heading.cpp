#include "vesalius/base/body_heading.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace vesalius {
namespace {

using Eigen::Vector3f;

constexpr float kLeastAcross_m = 0.1F;
/// Smallest share of the viewing direction across the body's axis: about 17 degrees off it.
constexpr float kLeastSeen = 0.3F;

/// The mean of the points that are known.
class MeanPoint {
 public:
  void add(const Vector3f& point) {
    if (point.hasNaN()) return;
    sum_ += point;
    count_ += 1.F;
  }
  bool empty() const { return count_ == 0.F; }
  Vector3f value() const { return sum_ / std::max(1.F, count_); }

 private:
  Vector3f sum_ = Vector3f::Zero();
  float count_ = 0.F;
};

}  // namespace

Vector3f body_up(const std::vector<Vector3f>& centres, const BodyModel& body) {
  MeanPoint upper, lower;
  for (std::size_t p = 0; p < centres.size(); ++p) (body.parts[p].upper_body ? upper : lower).add(centres[p]);
  const Vector3f up = upper.value() - lower.value();
  if (upper.empty() || lower.empty() || up.norm() < kLeastAcross_m) return -Vector3f::UnitY();
  return up.normalized();
}

std::optional<float> body_yaw(const std::vector<Vector3f>& centres, const BodyModel& body) {
  MeanPoint across, middle;
  for (std::size_t p = 0; p < centres.size() && p < body.parts.size(); ++p) {
    middle.add(centres[p]);
    if (body.parts[p].name.starts_with("l_")) across.add(centres[p] - centres[body.parts[p].mirror]);
  }
  if (across.empty() || middle.value().norm() == 0.F) return std::nullopt;
  const Vector3f up = body_up(centres, body);
  const Vector3f left = across.value() - across.value().dot(up) * up;
  if (left.norm() < kLeastAcross_m) return std::nullopt;
  const Vector3f to_left = left.normalized();
  const Vector3f to_front = to_left.cross(up);
  const Vector3f to_camera = -middle.value().normalized();
  const float ahead = to_camera.dot(to_front);
  const float aside = to_camera.dot(to_left);
  if (std::hypot(ahead, aside) < kLeastSeen) return std::nullopt;
  return std::atan2(-aside, ahead);
}

int heading_of_yaw(float yaw_rad, int headings) {
  constexpr float kTurn = 2.F * std::numbers::pi_v<float>;
  const auto nearest = int(std::lround(yaw_rad / kTurn * float(headings)));
  return (nearest % headings + headings) % headings;
}

}  // namespace vesalius
