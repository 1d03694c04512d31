#include "vesalius/track/track_stance.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

namespace vesalius {
namespace {

constexpr float kDegree = std::numbers::pi_v<float> / 180.F;
constexpr float kUpright_rad = 40.F * kDegree;
constexpr float kLying_rad = 60.F * kDegree;  // between the two nothing is said: bent people do either
constexpr float kBent_m = 0.7F;               // whose hips are as high bends over
constexpr float kOnFloor_m = 0.4F;            // of hips and head alike, the body's thickness included; beds are higher
// Hips over head is 0.55 to 0.62 of people who stand and 0.49 to 0.54 of people on chairs, whatever their stature;
// knees over hips 0.5 and 0.8. Measured on parts found in recordings (docs/tracking.md).
constexpr float kStandingRatio = 0.57F;
constexpr float kSittingRatio = 0.53F;
constexpr float kStandingKnees = 0.65F;
constexpr float kSittingKnees = 0.72F;
constexpr float kStandingPelvis_m = 0.7F;  // of adults, where the others leave it open
constexpr float kSittingPelvis_m = 0.6F;

constexpr double kLasts_s = 0.5;      // for which a stance must be seen
constexpr double kFallLasts_s = 1.0;  // the same for one that alarms
constexpr int kLeastFrames = 3;
constexpr double kFall_s = 2.0;   // from upright to the floor
constexpr double kLong_s = 10.0;  // on the floor, without a fall that was seen
constexpr double kForgotten_s = 5.0;

/// The mean of the seen parts whose names end so; `count` is their number.
struct SeenPart {
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  int count = 0;
};

SeenPart seen_part(const Skeleton& skeleton, const BodyModel& body, std::string_view ending) {
  SeenPart seen;
  for (std::size_t p = 0; p < std::min(body.parts.size(), skeleton.parts.size()); ++p) {
    const SkeletonPart& part = skeleton.parts[p];
    if (part.state != State::observed || !body.parts[p].name.ends_with(ending) || !part.centre.allFinite()) continue;
    seen.centre += part.centre;
    ++seen.count;
  }
  if (seen.count > 0) seen.centre /= static_cast<float>(seen.count);
  return seen;
}

/// What a posture is by itself; unknown where it may be several.
enum class Shape { unknown, standing, sitting, lying, on_floor };

/// Tells standing from sitting; `value` is high for `high` and low for `low`.
Shape tell(float value, float most_low, Shape low, float least_high, Shape high) {
  return value >= least_high ? high : value < most_low ? low : Shape::unknown;
}

Shape upright_shape(const Posture& posture) {
  const float pelvis_m = *posture.pelvis_m;
  Shape shape = Shape::unknown;
  if (posture.head_seen) {
    shape = tell(pelvis_m / *posture.head_m, kSittingRatio, Shape::sitting, kStandingRatio, Shape::standing);
  }
  if (shape == Shape::unknown && posture.knee_m) {
    shape = tell(*posture.knee_m / pelvis_m, kStandingKnees, Shape::standing, kSittingKnees, Shape::sitting);
  }
  if (shape != Shape::unknown) return shape;
  return tell(pelvis_m, kSittingPelvis_m, Shape::sitting, kStandingPelvis_m, Shape::standing);
}

Shape shape_of(const Posture& posture) {
  if (posture.trunk_rad >= kLying_rad) {
    if (!posture.hips_seen) return Shape::unknown;
    if (!posture.pelvis_m) return Shape::lying;
    if (*posture.pelvis_m > kBent_m) return Shape::standing;
    return std::max(*posture.pelvis_m, *posture.head_m) <= kOnFloor_m ? Shape::on_floor : Shape::lying;
  }
  const bool known = posture.pelvis_m && *posture.pelvis_m > 0.F && *posture.head_m > *posture.pelvis_m;
  if (posture.trunk_rad > kUpright_rad || !known) return Shape::unknown;
  return upright_shape(posture);
}

}  // namespace

std::optional<Posture> posture_of(const Skeleton& skeleton, const BodyModel& body,
                                  const std::optional<Eigen::Vector3f>& up, std::optional<float> height_m,
                                  const std::optional<Eigen::Vector3f>& fitted_hips) {
  SeenPart hips = seen_part(skeleton, body, "hips");
  const bool hips_seen = hips.count > 0;
  if (!hips_seen && fitted_hips) hips = {*fitted_hips, 1};
  if (!up || hips.count == 0) return std::nullopt;
  SeenPart head = seen_part(skeleton, body, "face_top");
  if (head.count == 0) head = seen_part(skeleton, body, "face_bottom");
  const SeenPart neck = seen_part(skeleton, body, "neck"), chest = seen_part(skeleton, body, "chest");
  SeenPart above;
  for (const SeenPart& part : {chest, neck, head}) {
    if (part.count == 0) continue;
    above.centre += part.centre;
    ++above.count;
  }
  if (above.count == 0) return std::nullopt;
  const Eigen::Vector3f axis = above.centre / static_cast<float>(above.count) - hips.centre;
  if (axis.norm() < 0.05F) return std::nullopt;  // seen along the body
  Posture posture;
  posture.trunk_rad = std::acos(std::clamp(axis.normalized().dot(*up), -1.F, 1.F));
  posture.hips_seen = hips_seen;
  posture.head_seen = head.count > 0;
  if (!height_m) return posture;
  const SeenPart& top = head.count > 0 ? head : neck.count > 0 ? neck : chest;
  posture.pelvis_m = *height_m + up->dot(hips.centre);
  posture.head_m = *height_m + up->dot(top.centre);
  const SeenPart knees = seen_part(skeleton, body, "knee");
  if (knees.count > 0) posture.knee_m = *height_m + up->dot(knees.centre);
  return posture;
}

std::optional<Eigen::Vector3f> trusted_hips(const FittedBody& fitted, const FleshModel& flesh) {
  constexpr float kTrusted = 0.5F;
  const int index = flesh.find_bone("pelvis");
  if (index < 0) return std::nullopt;
  // The centres of the parts that are called hips lie 5 to 10 cm above the joints of the legs, where this bone ends.
  const FittedBone& pelvis = fitted.bones[static_cast<std::size_t>(index)];
  if (pelvis.state == State::none || pelvis.tail_confidence < kTrusted) return std::nullopt;
  return pelvis.tail;
}

std::optional<std::pair<Stance, double>> TrackStance::change(Stance stance, double since_s) {
  if (stance == stance_) return std::nullopt;
  stance_ = stance;
  return std::make_pair(stance, since_s);
}

std::optional<std::pair<Stance, double>> TrackStance::update(const std::optional<Posture>& posture, double time_s) {
  const Shape shape = posture ? shape_of(*posture) : Shape::unknown;
  if (shape == Shape::unknown) {
    if (!known_s_ || time_s - *known_s_ < kForgotten_s) return std::nullopt;
    const double since_s = *known_s_;
    seen_ = {};
    known_s_.reset();
    upright_s_.reset();
    return change(Stance::unknown, since_s);
  }
  known_s_ = time_s;
  const bool down = shape == Shape::on_floor;
  const Stance stance = shape == Shape::standing  ? Stance::standing
                        : shape == Shape::sitting ? Stance::sitting
                        : down                    ? Stance::fallen
                                                  : Stance::lying;
  if (stance != seen_.stance) {
    seen_ = {stance, time_s, 0};
    fell_ = upright_s_ && time_s - *upright_s_ <= kFall_s;
  }
  ++seen_.frames;
  // Who sits on the floor and lies down has not fallen.
  const bool upright = shape == Shape::standing || shape == Shape::sitting;
  if (upright && posture->pelvis_m && *posture->pelvis_m > kOnFloor_m) upright_s_ = time_s;
  const double lasted_s = time_s - seen_.since_s;
  if (seen_.frames < kLeastFrames || lasted_s < (down ? kFallLasts_s : kLasts_s)) return std::nullopt;
  const bool fallen = fell_ || lasted_s >= kLong_s || stance_ == Stance::fallen;
  return change(down && !fallen ? Stance::lying : stance, seen_.since_s);
}

}  // namespace vesalius
