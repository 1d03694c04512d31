#include "metrics/frame_truth.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "vesalius/base/body_heading.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;

constexpr float kFront_rad = std::numbers::pi_v<float> / 3.F;
constexpr float kBack_rad = 2.F * std::numbers::pi_v<float> / 3.F;
constexpr float kLeastAcross_m = 0.1F;

/// Returns the mean vector from right points to their left partners, seen from above (x right, z forward), metres.
Eigen::Vector2f right_to_left(const SidedNames& names, const std::vector<Vector3f>& points) {
  std::vector<Vector3f> across;
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (names.is_left(p) && names.partner[p] >= 0) across.emplace_back(points[p] - points[names.partner[p]]);
  }
  const Vector3f mean = mean_known(across);
  return {mean.x(), mean.z()};
}

Heading side_of_turn(float turn_rad) {
  return turn_rad <= kFront_rad ? Heading::front : turn_rad <= kBack_rad ? Heading::side : Heading::back;
}

}  // namespace

const char* to_string(Heading heading) {
  switch (heading) {
    case Heading::front:
      return "front";
    case Heading::side:
      return "side";
    default:
      return "back";
  }
}

Mask labelled_people(const FrameTruth& truth) {
  constexpr std::uint8_t kMost = 254;
  Mask people(truth.labels.width(), truth.labels.height(), 0);
  for (std::size_t i = 0; i < people.size(); ++i) {
    if (truth.labels[i] == kBackground) continue;
    const bool known = !truth.person.empty() && truth.person[i] < kMost;
    people[i] = static_cast<std::uint8_t>(known ? truth.person[i] + 1 : 1);
  }
  return people;
}

Vector3f mean_known(const std::vector<Vector3f>& points) {
  Vector3f sum = Vector3f::Zero();
  float count = 0.F;
  for (const Vector3f& p : points) {
    if (p.hasNaN()) continue;
    sum += p;
    count += 1.F;
  }
  return sum / std::max(1.F, count);
}

SidedNames sided(const BodyModel& body) {
  SidedNames sided;
  for (int p = 0; p < body.part_count(); ++p) {
    sided.names.push_back(body.parts[p].name);
    sided.partner.push_back(body.parts[p].mirror == p ? -1 : body.parts[p].mirror);
  }
  return sided;
}

SidedNames sided(const std::vector<std::string>& names) {
  SidedNames sided{names, {}};
  for (const std::string& name : names) {
    std::string other = name;
    if (name.starts_with("l_")) other[0] = 'r';
    if (name.starts_with("r_")) other[0] = 'l';
    const auto found = std::ranges::find(names, other);
    const bool has = other != name && found != names.end();
    sided.partner.push_back(has ? int(found - names.begin()) : -1);
  }
  return sided;
}

std::optional<Heading> heading_of(const SidedNames& names, const std::vector<Vector3f>& points) {
  const Eigen::Vector2f left = right_to_left(names, points);
  const Vector3f centre = mean_known(points);
  const Eigen::Vector2f to_camera(-centre.x(), -centre.z());
  if (left.norm() < kLeastAcross_m || to_camera.norm() == 0.F) return std::nullopt;
  const Eigen::Vector2f front(left.y(), -left.x());  // whose left is at the picture's right faces the camera
  const float turn = std::acos(std::clamp(front.dot(to_camera) / (front.norm() * to_camera.norm()), -1.F, 1.F));
  return side_of_turn(turn);
}

std::optional<Heading> heading_of(const FrameTruth& truth, std::size_t person, const BodyModel& body) {
  if (person < truth.parts.size()) {
    const std::optional<float> yaw = body_yaw(truth.parts[person], body);
    if (!yaw) return std::nullopt;
    return side_of_turn(std::abs(*yaw));
  }
  if (truth.heading || person >= truth.joints.size()) return truth.heading;
  return heading_of(sided(truth.joint_names), truth.joints[person]);
}

}  // namespace vesalius
