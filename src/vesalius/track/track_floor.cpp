#include "vesalius/track/track_floor.h"

#include <algorithm>
#include <cmath>

#include "vesalius/planes/find_planes.h"

namespace vesalius {
namespace {

constexpr float kSameCosine = 0.9962F;  // 5 degrees: one plane in neighbouring frames of a moving camera
constexpr float kSameHeight_m = 0.15F;
constexpr float kStillCosine = 0.99985F;  // 1 degree: the noise of a plane's normal; more is a camera that moves
constexpr float kStillHeight_m = 0.03F;
constexpr double kStill_s = 2.0;  // over which the floor of a still camera is averaged
constexpr double kMoving_s = 0.1;
constexpr double kLasting_s = 0.3;  // for which a plane must be seen to become the floor ...
constexpr int kLastingFrames = 5;
constexpr double kTable_s = 5.0;            // ... or above the floor so far, which may only be hidden
constexpr double kMoved_s = 1.0;            // without the floor and with no plane that was seen with it
constexpr double kFloorForgotten_s = 20.0;  // without any floor

bool same(const Plane& a, const Plane& b, float cosine, float height_m) {
  return a.normal.dot(b.normal) >= cosine && std::abs(a.offset - b.offset) <= height_m;
}

/// Moves a plane to another by a share of their difference.
void approach(Plane& plane, const Plane& to, float share) {
  plane.normal = (plane.normal + share * (to.normal - plane.normal)).normalized();
  plane.offset += share * (to.offset - plane.offset);
  plane.area_m2 = to.area_m2;
}

}  // namespace

void TrackFloor::update(const std::vector<Plane>& planes, const std::optional<Eigen::Vector3f>& up, double passed_s,
                        const Eigen::Vector3f& guess) {
  std::optional<Eigen::Vector3f> upwards = up;
  if (!upwards && floor_) upwards = -floor_->normal;
  const std::optional<Plane> seen = find_floor(planes, upwards, guess);
  unseen_s_ += passed_s;
  if (seen && floor_ && same(*seen, *floor_, kSameCosine, kSameHeight_m)) {
    follow(*seen, passed_s);
    around_ = planes;
  } else if (seen) {
    doubt(*seen, passed_s);
  }
  forget_if_moved(planes, passed_s);
  if (unseen_s_ > kFloorForgotten_s) floor_.reset();
}

/// A camera that is turned away from the floor no longer sees the walls that it saw with it either.
void TrackFloor::forget_if_moved(const std::vector<Plane>& planes, double passed_s) {
  const bool known = std::ranges::any_of(planes, [&](const Plane& plane) {
    return std::ranges::any_of(around_,
                               [&](const Plane& other) { return same(plane, other, kSameCosine, kSameHeight_m); });
  });
  elsewhere_s_ = known ? 0.0 : elsewhere_s_ + passed_s;
  if (elsewhere_s_ > kMoved_s && unseen_s_ > kMoved_s) floor_.reset();
}

void TrackFloor::follow(const Plane& seen, double passed_s) {
  const bool still = same(seen, *floor_, kStillCosine, kStillHeight_m);
  approach(*floor_, seen, float(1.0 - std::exp(-passed_s / (still ? kStill_s : kMoving_s))));
  rival_.reset();
  unseen_s_ = 0.0;
}

void TrackFloor::doubt(const Plane& seen, double passed_s) {
  const bool goes_on = rival_ && same(seen, *rival_, kSameCosine, kSameHeight_m);
  rival_s_ = goes_on ? rival_s_ + passed_s : 0.0;
  rival_frames_ = goes_on ? rival_frames_ + 1 : 1;
  rival_ = seen;
  const bool above = floor_ && seen.normal.dot(floor_->normal) >= kSameCosine && seen.offset < floor_->offset;
  if (rival_frames_ < kLastingFrames || rival_s_ < (above ? kTable_s : kLasting_s)) return;
  floor_ = rival_;
  rival_.reset();
  unseen_s_ = 0.0;
  around_.clear();
  elsewhere_s_ = 0.0;
}

std::optional<FloorView> TrackFloor::view() const {
  if (!floor_) return std::nullopt;
  return view_of_floor(*floor_);
}

FloorView view_of_floor(const Plane& floor) {
  const Eigen::Vector3f up = -floor.normal;
  return {up, floor.offset, std::asin(std::clamp(-up.z(), -1.F, 1.F)), std::atan2(-up.x(), -up.y())};
}

Eigen::Isometry3f floor_from_optical(const FloorView& view) {
  constexpr float kLeastForward = 1e-3F;
  const Eigen::Vector3f up = view.up.normalized();
  const auto level = [&](const Eigen::Vector3f& direction) -> Eigen::Vector3f {
    return direction - up * up.dot(direction);
  };
  Eigen::Vector3f forward = level(Eigen::Vector3f::UnitZ());
  // A camera that looks straight down has its picture's upper edge in front.
  if (forward.norm() < kLeastForward) forward = level(-Eigen::Vector3f::UnitY());
  forward.normalize();
  Eigen::Matrix3f rotation;
  rotation.row(0) = forward.cross(up).transpose();
  rotation.row(1) = -up.transpose();
  rotation.row(2) = forward.transpose();
  Eigen::Isometry3f transformation = Eigen::Isometry3f::Identity();
  transformation.linear() = rotation;
  transformation.translation() = Eigen::Vector3f(0.F, -view.height_m, 0.F);
  return transformation;
}

}  // namespace vesalius
