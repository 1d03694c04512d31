#include "synth/scene/fit_support.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "synth/furniture/care.h"
#include "synth/furniture/seats.h"
#include "synth/mesh/palette.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

constexpr float kLowestSeat_m = 0.16F;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Returns the bone that moves each vertex most.
std::vector<Bone> main_bones(const BodyMesh& mesh) {
  std::vector<Bone> of_rig;
  for (const RigBone& bone : mesh.rig) of_rig.push_back(bone.blend < 0.5F ? bone.from : bone.to);
  std::vector<Bone> result;
  result.reserve(mesh.topology->skin.size());
  for (const SkinWeights& skin : mesh.topology->skin) {
    const auto heaviest = std::ranges::max_element(skin.weight) - skin.weight.begin();
    result.push_back(of_rig[skin.bone[heaviest]]);
  }
  return result;
}

bool is_seat_of(Bone bone) { return bone == Bone::pelvis || bone == Bone::l_thigh || bone == Bone::r_thigh; }
bool is_trunk(Bone bone) { return bone == Bone::pelvis || bone == Bone::spine || bone == Bone::chest; }
bool is_left_foot(Bone bone) { return bone == Bone::l_foot; }
bool is_right_foot(Bone bone) { return bone == Bone::r_foot; }
bool is_lower_leg(Bone bone) {
  return bone == Bone::l_shin || bone == Bone::r_shin || bone == Bone::l_foot || bone == Bone::r_foot;
}

/// The measures of a sitting body in a frame whose z axis runs forwards from below the hips.
class Sitter {
 public:
  Sitter(const BodyMesh& mesh, const PosedBody& body)
      : body_from_hips_(body_from_hips(body)), bones_(main_bones(mesh)) {
    const Eigen::Isometry3f hips_from_body = body_from_hips_.inverse();
    points_.reserve(body.vertices.size());
    for (const Vector3f& p : body.vertices) points_.emplace_back(hips_from_body * p);
    knee_z_ = std::min((hips_from_body * body.joints[index(Bone::l_shin)]).z(),
                       (hips_from_body * body.joints[index(Bone::r_shin)]).z());
    shoulder_y_ = body.ends[index(Bone::chest)].y();
  }

  std::optional<SeatFit> fit() const {
    const float lowest = lowest_of_seat();
    if (lowest < kLowestSeat_m) return std::nullopt;
    SeatFit fit;
    fit.height_m = lowest + kCushion_m;
    fit.lean_rad = std::clamp(lean(fit.height_m), 0.F, 0.6F);
    const float back_z = back_of_trunk(fit.height_m, std::tan(fit.lean_rad)) + kCushion_m;
    const float front_z = std::min(knee_z_ - 0.05F, front_of_calves(fit.height_m) - 0.01F);
    fit.depth_m = std::clamp(front_z - back_z, 0.2F, 0.8F);
    fit.half_width_m = half_width();
    fit.back_m = std::clamp(shoulder_y_ - fit.height_m, 0.25F, 0.7F);
    fit.body_from_seat = body_from_hips_ * Eigen::Translation3f(0.F, 0.F, back_z);
    for (std::size_t i = 0; i < fit.soles.size(); ++i) fit.soles[i] = sole(i == 0) - Vector3f(0.F, 0.F, back_z);
    return fit;
  }

 private:
  template <class Use>
  void for_each(bool (*wanted)(Bone), Use use) const {
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (wanted(bones_[i])) use(points_[i]);
    }
  }
  float lowest_of_seat() const {
    float lowest = kInfinity;
    for_each(is_seat_of, [&](const Vector3f& p) {
      if (p.z() < 0.7F * knee_z_) lowest = std::min(lowest, p.y());
    });
    return std::isfinite(lowest) ? lowest : 0.F;
  }
  /// Returns the lean of the line that touches the small of the back and the shoulder blades.
  float lean(float height) const {
    constexpr float kLow = 0.1F, kMiddle = 0.27F, kHigh = 0.5F;
    float low_z = kInfinity, high_z = kInfinity;
    for_each(is_trunk, [&](const Vector3f& p) {
      const float y = p.y() - height;
      if (y > kLow && y < kMiddle) low_z = std::min(low_z, p.z());
      if (y >= kMiddle && y < kHigh) high_z = std::min(high_z, p.z());
    });
    return std::isfinite(low_z - high_z) ? std::atan2(low_z - high_z, 0.5F * (kHigh - kLow)) : 0.F;
  }
  float back_of_trunk(float height, float slope) const {
    float back = kInfinity;
    for_each(is_trunk, [&](const Vector3f& p) {
      if (p.y() > height) back = std::min(back, p.z() + slope * (p.y() - height));
    });
    return std::isfinite(back) ? back : -0.15F;
  }
  /// Returns where the lower legs descend in front of the seat. Legs below the seat do not count.
  float front_of_calves(float height) const {
    float front = kInfinity;
    for_each(is_lower_leg, [&](const Vector3f& p) {
      if (p.y() > height - 0.12F && p.y() < height + 0.02F && p.z() > 0.1F) front = std::min(front, p.z());
    });
    return front;
  }
  float half_width() const {
    float half = 0.1F;
    for_each(is_seat_of, [&](const Vector3f& p) { half = std::max(half, std::abs(p.x())); });
    return half;
  }

  /// Returns the middle of a foot along the floor, at its lowest height.
  Vector3f sole(bool left) const {
    Eigen::AlignedBox3f foot;
    for_each(left ? is_left_foot : is_right_foot, [&](const Vector3f& p) { foot.extend(p); });
    return foot.isEmpty() ? Vector3f(0.F, 0.F, knee_z_)
                          : Vector3f(foot.center().x(), foot.min().y(), foot.center().z());
  }

  Eigen::Isometry3f body_from_hips_;
  std::vector<Bone> bones_;
  std::vector<Vector3f> points_;
  float knee_z_ = 0.F, shoulder_y_ = 0.F;
};

SeatShape draw_shape(const SeatFit& fit, SeatKind kind, Random& random) {
  SeatShape shape;
  shape.kind = kind;
  shape.height_m = fit.height_m;
  shape.depth_m = fit.depth_m * between(0.85, 1.0, random);
  shape.lean_rad = fit.lean_rad;
  shape.back_m = fit.back_m * between(0.6, 1.1, random);
  switch (kind) {
    case SeatKind::chair:
      shape.width_m = std::clamp(2.F * fit.half_width_m, 0.38F, 0.52F) * between(0.95, 1.05, random);
      break;
    case SeatKind::stool:
      shape.width_m = between(0.3, 0.4, random);
      shape.depth_m = std::min(shape.depth_m, 0.42F);
      break;
    case SeatKind::armchair:
      shape.width_m = std::max(0.5F, 2.F * fit.half_width_m + 0.04F) * between(1.0, 1.15, random);
      break;
    case SeatKind::sofa:
      shape.width_m = between(1.2, 2.2, random);
      break;
  }
  return shape;
}

}  // namespace

Eigen::Isometry3f body_from_hips(const PosedBody& body) {
  const Vector3f& left = body.joints[index(Bone::l_thigh)];
  const Vector3f& right = body.joints[index(Bone::r_thigh)];
  const Vector3f front = (left - right).cross(Vector3f::UnitY());
  const Vector3f middle = 0.5F * (left + right);
  return standing_at(middle.x(), 0.F, middle.z(), std::atan2(front.x(), front.z()));
}

std::optional<SeatFit> fit_seat(const BodyMesh& mesh, const PosedBody& body) { return Sitter(mesh, body).fit(); }

std::optional<Furniture> make_fitting_seat(const SeatFit& fit, const BodyOutline& body, float swell_m, Random& random) {
  constexpr int kTries = 5;
  const bool soft = swell_m > 0.F;
  for (int i = 0; i < kTries; ++i) {
    constexpr std::array<SeatKind, 6> kDraws = {SeatKind::chair,    SeatKind::chair, SeatKind::stool,
                                                SeatKind::armchair, SeatKind::sofa,  SeatKind::sofa};
    constexpr std::uint32_t kSoftFrom = 3;
    const std::uint32_t from = soft ? kSoftFrom : 0;
    const SeatKind kind = i + 1 == kTries ? SeatKind::stool : kDraws[from + random.below(kDraws.size() - from)];
    const SeatShape shape = draw_shape(fit, kind, random);
    Furniture seat = make_seat(shape, random);
    Eigen::Isometry3f place = fit.body_from_seat;
    if (kind == SeatKind::sofa) {  // the person sits anywhere on it
      const float room = 0.5F * shape.width_m - fit.half_width_m;
      place = place * Eigen::Translation3f(between(-1.0, 1.0, random) * std::max(0.F, room), 0.F, 0.F);
    }
    if (soft && kind != SeatKind::stool) add_seat_cushions(shape, swell_m, seat, random);
    move(seat, place);
    if (!sinks_in(body, seat.solids)) return seat;
  }
  return std::nullopt;
}

std::optional<CareSeat> make_care_seat(const SeatFit& fit, const BodyOutline& body, Random& random) {
  constexpr int kTries = 4;
  enum Kind : std::uint8_t { wheelchair, toilet, bench };
  constexpr std::array<Kind, 5> kDraws = {wheelchair, wheelchair, wheelchair, toilet, bench};
  for (int i = 0; i < kTries; ++i) {
    const Kind kind = kDraws[random.below(kDraws.size())];
    CareSeat made;
    SeatShape shape = draw_shape(fit, SeatKind::chair, random);
    Eigen::Isometry3f place = fit.body_from_seat;
    if (kind == wheelchair) {
      made.lift_m = between(0.05, 0.13, random);
      shape.height_m += made.lift_m;
      shape.width_m = std::max(shape.width_m, 2.F * fit.half_width_m + 0.02F);
      std::array<Vector3f, 2> soles = fit.soles;
      for (Vector3f& sole : soles) {
        constexpr float kRaised_m = 0.12F;  // a foot in the air, as of crossed legs, has its rest below it
        sole.y() = made.lift_m + (sole.y() < kRaised_m ? std::max(0.F, sole.y()) : 0.F);
      }
      made.seat = make_wheelchair(shape, soles, random);
    } else if (kind == toilet) {
      shape.depth_m = std::min(shape.depth_m, 0.46F);
      made.seat = make_toilet(shape, random);
    } else {
      shape.width_m = between(1.0, 1.9, random);
      made.seat = make_bench(shape, random);
      const float room = std::max(0.F, 0.5F * shape.width_m - fit.half_width_m);
      place = place * Eigen::Translation3f(between(-1.0, 1.0, random) * room, 0.F, 0.F);
    }
    move(made.seat, place);
    const Eigen::Isometry3f lifted(Eigen::Translation3f(0.F, made.lift_m, 0.F));
    if (!sinks_in(moved(body, lifted), made.seat.solids)) return made;
  }
  return std::nullopt;
}

BedFit fit_bed(const PosedBody& body) {
  const Vector3f feet = 0.5F * (body.ends[index(Bone::l_shin)] + body.ends[index(Bone::r_shin)]);
  const Vector3f axis = body.ends[index(Bone::head)] - feet;
  const Eigen::Isometry3f turned = standing_at(0.F, 0.F, 0.F, std::atan2(axis.x(), axis.z()));
  const Eigen::Isometry3f turned_from_body = turned.inverse();
  Eigen::AlignedBox3f bounds;
  for (const Vector3f& p : body.vertices) bounds.extend(turned_from_body * p);
  BedFit fit;
  fit.body_from_bed = turned * Eigen::Translation3f(bounds.center().x(), 0.F, bounds.center().z());
  fit.width_m = bounds.sizes().x();
  fit.length_m = bounds.sizes().z();
  return fit;
}

}  // namespace vesalius::synth
