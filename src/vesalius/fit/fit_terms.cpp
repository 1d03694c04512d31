#include "vesalius/fit/fit_terms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace vesalius {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

// Of a point, in units of the flesh's half width: its direction is not defined at 0.
constexpr double kLeastRadius = 0.1;
constexpr double kLeastHalf_m = 0.008;
constexpr float kAlong_m = 0.05F;    // standard deviation of a part's ends along its bone
constexpr float kSide_m = 0.05F;     // and of its border on the middle line
constexpr float kCentre_m = 0.08F;   // of the parts' centres, from which a fit starts
constexpr float kBeyond_rad = 0.1F;  // of a turn beyond a joint's range
constexpr float kFollow_rad = 0.1F;  // of a bone's turn from the expected one after a thirtieth second
constexpr double kOutlier = 3.0;     // deviations beyond which a point counts less and less
constexpr double kLimit = 3.0;  // deviations beyond which centres, outline, fast limbs and feet count less and less
constexpr double kBelowLimit = 6.0;  // the same of flesh below the ground, where starts may be far down

/// The flesh of a bone at a place along it.
struct CrossSection {
  std::array<double, 2> centre{}, half{};
  std::array<double, FleshBone::kStations> share{};  ///< share of each station
};

/// Returns this for numbers of the bone: those of somebody's shape, or what a shape adds.
template <class Number>
CrossSection section_of(const FleshBone& bone, const std::array<Number, FleshBone::kNumbers>& numbers, double along) {
  constexpr int kLast = FleshBone::kStations - 1;
  CrossSection section;
  int below = 0;
  while (below < kLast - 1 && along > double(bone.stations[below + 1])) ++below;
  const auto from = double(bone.stations[below]), to = double(bone.stations[below + 1]);
  const double above = std::clamp((along - from) / (to - from), 0.0, 1.0);
  section.share[below] = 1.0 - above;
  section.share[below + 1] = above;
  for (int i = 0; i < 2; ++i) {
    for (int s = 0; s < FleshBone::kStations; ++s) {
      section.centre[i] += section.share[s] * double(numbers[6 + 4 * s + i]);
      section.half[i] += section.share[s] * double(numbers[6 + 4 * s + 2 + i]);
    }
  }
  return section;
}

CrossSection section_at(const PlacedBone& placed, const FleshBone& bone, double along) {
  CrossSection section = section_of(bone, placed.numbers, along);
  for (double& half : section.half) half = std::max(half, kLeastHalf_m);
  return section;
}

/// Returns a point of a cross-section of these numbers in the bone's frame, `across` half widths from its middle.
template <class Number>
Vector3d point_of(const FleshBone& bone, const std::array<Number, FleshBone::kNumbers>& numbers,
                  const CrossSection& section, double along, const std::array<double, 2>& across = {}) {
  const std::array<int, 2> axes = axes_across(bone.axis);
  Vector3d point;
  point[bone.axis] = along * double(numbers[3 + bone.axis]);
  for (int i = 0; i < 2; ++i) point[axes[i]] = section.centre[i] + across[i] * section.half[i];
  return point;
}

/// Returns the middle of the surface of a part's stretches.
PartSurface::Middle middle_of(const std::vector<PartSurface::Stretch>& stretches, const FleshModel& flesh,
                              const std::vector<PlacedBone>& rest) {
  constexpr int kRings = 16;
  constexpr double kLeastLength = 1e-3;  // of a stretch beyond the last station, where a bone's rounded end is
  PartSurface::Middle middle;
  Vector3d sum = Vector3d::Zero();
  double area = 0.0, longest = 0.0;
  for (const PartSurface::Stretch& stretch : stretches) {
    const FleshBone& bone = flesh.bones[stretch.bone];
    const PlacedBone& placed = rest[stretch.bone];
    const auto first = double(bone.stations.front()), last = double(bone.stations.back());
    const double from = std::clamp(stretch.from, first, last);
    const double length = std::max(std::clamp(stretch.to, first, last) - from, kLeastLength);
    const double length_m = length * std::abs(placed.numbers[3 + bone.axis]);
    if (length_m > longest) middle.bone = stretch.bone;
    longest = std::max(longest, length_m);
    const double aside = stretch.side * 2.0 / std::numbers::pi;  // the mean of half a circle
    for (int ring = 0; ring < kRings; ++ring) {
      const double along = from + length * (ring + 0.5) / kRings;
      const CrossSection section = section_at(placed, bone, along);
      const double around = (section.half[0] + section.half[1]) * (stretch.side != 0 ? 0.5 : 1.0);
      sum += length_m * around * (placed.head + point_of(bone, placed.numbers, section, along, {aside, 0.0}));
      area += length_m * around;
    }
  }
  if (middle.bone < 0) return middle;
  const FleshBone& bone = flesh.bones[middle.bone];
  const PlacedBone& placed = rest[middle.bone];
  const Vector3d point = sum / area - placed.head;
  middle.along = point[bone.axis] / placed.numbers[3 + bone.axis];
  const CrossSection section = section_at(placed, bone, middle.along);
  const std::array<int, 2> axes = axes_across(bone.axis);
  for (int i = 0; i < 2; ++i) middle.across[i] = (point[axes[i]] - section.centre[i]) / section.half[i];
  middle.by_shape.resize(3, flesh.shapes);
  for (Index k = 0; k < middle.by_shape.cols(); ++k) {
    const CrossSection change = section_of(bone, bone.shapes[k], middle.along);
    middle.by_shape.col(k) = point_of(bone, bone.shapes[k], change, middle.along, middle.across);
  }
  return middle;
}

/// The lowest place of a bone's flesh.
struct LowPlace {
  int bone = -1, station = 0;
  Vector3d at = Vector3d::Zero();
  double height_m = std::numeric_limits<double>::max();
};

/// By how much the half widths of an ellipse, each along its axis, rise upwards. `up` is in the bone's frame.
Eigen::Vector2d rise_of(const FleshEllipse<double>& ellipse, const Vector3d& up) {
  return {ellipse.half[0] * up[ellipse.across[0]], ellipse.half[1] * up[ellipse.across[1]]};
}

double reach_of(const Eigen::Vector2d& rise) { return std::max(std::hypot(rise[0], rise[1]), 1e-9); }

LowPlace low_place(const Ground& ground, int index, const PlacedBone& placed, const FleshBone& bone) {
  const Vector3d up = placed.global.transpose() * ground.up;
  LowPlace lowest;
  for (int s = 0; s < FleshBone::kStations; ++s) {
    const FleshEllipse<double> ellipse = ellipse_of(bone, placed.numbers, s);
    const Eigen::Vector2d rise = rise_of(ellipse, up);
    const double reach = reach_of(rise);
    Vector3d point = ellipse.centre;
    for (int i = 0; i < 2; ++i) point[ellipse.across[i]] -= ellipse.half[i] * rise[i] / reach;
    const Vector3d at = placed.head + placed.global * point;
    const double height_m = ground.height_of(at);
    if (height_m < lowest.height_m) lowest = {index, s, at, height_m};
  }
  return lowest;
}

/// Returns the derivative of the height of a place by the shape, the bone's head left out.
Eigen::VectorXd height_by_shape(const Ground& ground, const LowPlace& place, const PlacedBone& placed,
                                const FleshBone& bone) {
  const Vector3d up = placed.global.transpose() * ground.up;
  const FleshEllipse<double> ellipse = ellipse_of(bone, placed.numbers, place.station);
  const Eigen::Vector2d rise = rise_of(ellipse, up);
  const double reach = reach_of(rise);
  Eigen::VectorXd by_shape(static_cast<Index>(bone.shapes.size()));
  for (Index k = 0; k < by_shape.size(); ++k) {
    const FleshEllipse<float> change = ellipse_of(bone, bone.shapes[k], place.station);
    by_shape[k] = change.centre.cast<double>().dot(up);
    for (int i = 0; i < 2; ++i) {
      by_shape[k] -= double(change.half[i]) * rise[i] * up[ellipse.across[i]] / reach;
    }
  }
  return by_shape;
}

double geman_mcclure(double squared, double limit) { return squared / (1.0 + squared / (limit * limit)); }
double geman_mcclure_weight(double squared, double limit) {
  const double share = 1.0 / (1.0 + squared / (limit * limit));
  return share * share;
}

/// Returns the weight of rows whose squared deviations sum to `squared`, such that they pull as weight times the robust
/// cost does, and adds to the cost what their own squares leave out of that.
double robust_weight(double squared, double limit, double weight, NormalEquations& equations) {
  const double of_rows = weight * geman_mcclure_weight(squared, limit);
  equations.add_cost(weight * geman_mcclure(squared, limit) - of_rows * squared);
  return of_rows;
}

}  // namespace

PartSurface::PartSurface(const BodyModel& body, const FleshModel& flesh) : of_part(body.parts.size()) {
  constexpr double kBeyond = 10.0;
  for (const SurfaceRule& rule : body.surface) {
    const int bone = flesh.find_bone(rule.bone);
    if (bone < 0) continue;
    Stretch stretch;
    stretch.bone = bone;
    stretch.from = rule.from <= 0.F ? -kBeyond : double(rule.from);
    stretch.to = rule.to >= 1.F ? kBeyond : double(rule.to);
    stretch.side = rule.side == SurfaceRule::Side::left ? 1 : rule.side == SurfaceRule::Side::right ? -1 : 0;
    of_part[rule.part].push_back(stretch);
  }
  const BodyState rest{Vector3d::Zero(), std::vector(flesh.bones.size(), Eigen::Quaterniond::Identity()),
                       Eigen::VectorXd::Zero(flesh.shapes)};
  const std::vector<PlacedBone> placed = place_bones(flesh, rest);
  for (const auto& stretches : of_part) middle_of_part.push_back(middle_of(stretches, flesh, placed));
}

/// How a point lies to the flesh of a stretch of a bone.
struct FitTerms::Hit {
  double distance = 0.0;  ///< outside of the surface, metres
  Vector3d normal;        ///< normal of the surface, optical frame
  double along = 0.0;     ///< beyond the stretch's nearer end, metres, away from the bone's head positive
  double end = 0.0;       ///< which end: place along the bone
  double side = 0.0;      ///< on the wrong side of the middle, metres, not below 0
  double behind = 0.0;    ///< beyond the flesh's middle as the camera sees it, metres, not below 0
  Vector3d ray;
  CrossSection section;
  std::array<double, 2> across_normal, unit;         ///< normal and place in units of half widths, across the bone
  double cost = std::numeric_limits<double>::max();  ///< squared deviations with what the label costs
  double squared = 0.0;
};

FitTerms::FitTerms(const FleshModel& flesh, const BodyModel& body, const FitOptions& options)
    : flesh_(flesh), body_(body), options_(options), surface_(body, flesh) {
  for (int b = 0; b < flesh.bone_count(); ++b) {
    if (flesh.bones[b].name.ends_with("foot")) feet_.push_back(b);
  }
}

double FitTerms::walk_cost(const ExpectedBody& expected, const BodyState& state) const {
  constexpr double kStands_m_s = 0.3, kWalks_m_s = 0.8;
  constexpr double kBent = 0.8, kUpright = 0.95;  // cosine from the trunk to up
  constexpr double kSteep = 0.75, kLevel = 0.25;  // speed up or down for that along the ground
  const auto share = [](double value, double none, double all) {
    return std::clamp((value - none) / (all - none), 0.0, 1.0);
  };
  const Eigen::Matrix3d turn = state.local[0].toRotationMatrix();  // left, up and front
  const Vector3d up = expected.ground ? expected.ground->up : Vector3d(turn.col(1));
  const double rise = expected.velocity.dot(up);
  const Vector3d along = expected.velocity - rise * up;
  const double speed = along.norm(), forward = along.dot(turn.col(2));
  if (forward >= 0.0 || speed <= kStands_m_s) return 0.0;
  const double walks = share(speed, kStands_m_s, kWalks_m_s) * share(std::abs(rise) / speed, kSteep, kLevel) *
                       share(turn.col(1).dot(up), kBent, kUpright);
  return double(options_.walk_cost) * walks * -forward / speed;
}

FitTerms::Hit FitTerms::hit(const PlacedBone& placed, int index, const PartSurface::Stretch& stretch,
                            const Vector3d& at) const {
  const FleshBone& bone = flesh_.bones[index];
  Hit hit;
  const Vector3d q = placed.global.transpose() * (at - placed.head);
  const double length = placed.numbers[3 + bone.axis];
  const double along = q[bone.axis] / length;
  const auto first = double(bone.stations.front()), last = double(bone.stations.back());
  const double inside = std::clamp(along, first, last);
  hit.section = section_at(placed, bone, inside);
  const std::array<int, 2> across = axes_across(bone.axis);
  Vector3d gradient = Vector3d::Zero();
  double radius = 0.0;
  for (int i = 0; i < 2; ++i) {
    hit.unit[i] = (q[across[i]] - hit.section.centre[i]) / hit.section.half[i];
    gradient[across[i]] = hit.unit[i] / hit.section.half[i];
    radius += hit.unit[i] * hit.unit[i];
  }
  const double cap = std::min(hit.section.half[0], hit.section.half[1]);
  const double over = (along - inside) * length / cap;
  gradient[bone.axis] = over / cap;
  radius = std::sqrt(radius + over * over);
  const double steep = gradient.norm();
  if (radius < kLeastRadius || steep < 1e-9) {  // in the middle: the surface towards the camera is meant
    hit.ray = at.normalized();
    hit.distance = -cap;
    hit.normal = -hit.ray;
    hit.across_normal = {0.0, 0.0};
  } else {
    hit.distance = (radius - 1.0) * radius / steep;
    const Vector3d normal = gradient / steep;
    hit.across_normal = {normal[across[0]], normal[across[1]]};
    hit.normal = placed.global * normal;
    hit.ray = at.normalized();
  }
  const Vector3d middle = placed.head + placed.global * point_of(bone, placed.numbers, hit.section, inside);
  hit.behind = std::max(0.0, hit.ray.dot(at - middle));
  if (along < stretch.from) {
    hit.end = stretch.from;
  } else if (along > stretch.to) {
    hit.end = stretch.to;
  } else {
    hit.end = along;
  }
  hit.along = (along - hit.end) * length;
  if (stretch.side != 0) hit.side = std::max(0.0, -stretch.side * q.x());
  const auto square = [](double value, float sigma) {
    const double deviations = value / double(sigma);
    return deviations * deviations;
  };
  hit.squared = square(hit.distance, options_.surface_m) + square(hit.along, kAlong_m) + square(hit.side, kSide_m) +
                square(hit.behind, options_.surface_m);
  hit.cost = geman_mcclure(hit.squared, kOutlier);
  return hit;
}

std::vector<FitTerms::Assigned> FitTerms::assign(const FitData& data, const std::vector<PlacedBone>& placed) const {
  std::vector<Assigned> assigned(data.points.size());
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    const PersonPoint& point = data.points[i];
    const Vector3d at = point.at.cast<double>();
    double least = std::numeric_limits<double>::max();
    const auto offer = [&](int part, double label_cost) {
      if (label_cost >= least) return;
      for (const PartSurface::Stretch& stretch : surface_.of_part[part]) {
        const double cost = hit(placed[stretch.bone], stretch.bone, stretch, at).cost + label_cost;
        if (cost >= least) continue;
        least = cost;
        assigned[i] = {stretch, label_cost};
      }
    };
    for (int k = 0; k < PersonPoint::kParts && point.part[k] != kBackground && point.share[k] > 0.F; ++k) {
      const int part = point.part[k], mirror = body_.parts[part].mirror;
      const double cost = -2.0 * std::log(double(point.share[k]));
      offer(part, cost);
      if (mirror >= 0 && mirror != part) offer(mirror, cost + double(kMirrorCost));
    }
  }
  return assigned;
}

void FitTerms::add_points(const FitData& data, const std::vector<PlacedBone>& placed,
                          const std::vector<Assigned>& assigned, NormalEquations& equations) const {
  const auto point_weight = double(kPointWeight);
  const auto inverse_square = [](float sigma) { return 1.0 / (double(sigma) * double(sigma)); };
  const double surface = inverse_square(options_.surface_m), along = inverse_square(kAlong_m),
               side = inverse_square(kSide_m);
  Eigen::VectorXd by_shape(flesh_.shapes);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(flesh_.shapes);
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    const int b = assigned[i].stretch.bone;
    if (b < 0) continue;
    const Vector3d at = data.points[i].at.cast<double>();
    const Hit hit = this->hit(placed[b], b, assigned[i].stretch, at);
    const FleshBone& bone = flesh_.bones[b];
    const double weight = point_weight * geman_mcclure_weight(hit.squared, kOutlier);
    // The rows' squares sum to weight * squared; what the robust cost and the label add is constant.
    equations.add_cost(point_weight * (hit.cost + assigned[i].label_cost) - weight * hit.squared);
    for (Index k = 0; k < by_shape.size(); ++k) {
      const FleshBone::Numbers& by = bone.shapes[k];
      double change = 0.0;
      for (int s = 0; s < FleshBone::kStations; ++s) {
        for (int c = 0; c < 2; ++c) {
          change -= hit.section.share[s] * hit.across_normal[c] *
                    (double(by[6 + 4 * s + c]) + hit.unit[c] * double(by[6 + 4 * s + 2 + c]));
        }
      }
      by_shape[k] = change;
    }
    equations.add_point(b, at, -hit.normal, by_shape, hit.distance, weight * surface);
    if (hit.along != 0.0) {
      const Vector3d axis = placed[b].global.col(bone.axis) * (placed[b].numbers[3 + bone.axis] > 0.0 ? 1.0 : -1.0);
      const double sign = placed[b].numbers[3 + bone.axis] > 0.0 ? 1.0 : -1.0;
      for (Index k = 0; k < by_shape.size(); ++k) {
        by_shape[k] = -hit.end * sign * double(bone.shapes[k][3 + bone.axis]);
      }
      equations.add_point(b, at, -axis, by_shape, sign * hit.along, weight * along);
    }
    if (hit.side > 0.0) {
      const Vector3d towards = assigned[i].stretch.side * placed[b].global.col(0);
      equations.add_point(b, at, towards, none, hit.side, weight * side);
    }
    if (hit.behind > 0.0) equations.add_point(b, at, -hit.ray, none, hit.behind, weight * surface);
  }
}

FitTerms::PartPlace FitTerms::place_of(int part, const std::vector<PlacedBone>& placed) const {
  const PartSurface::Middle& middle = surface_.middle_of_part[part];
  const FleshBone& bone = flesh_.bones[middle.bone];
  const PlacedBone& at = placed[middle.bone];
  const CrossSection section = section_at(at, bone, middle.along);
  const Vector3d point = point_of(bone, at.numbers, section, middle.along, middle.across);
  return {middle.bone, at.head + at.global * point, std::min(section.half[0], section.half[1]),
          at.global * middle.by_shape};
}

void FitTerms::add_pull(const PartPlace& place, const Vector3d& off, double sigma_m, NormalEquations& equations) const {
  const double information = 1.0 / (sigma_m * sigma_m);
  const double weight = information * robust_weight(information * off.squaredNorm(), kLimit, 1.0, equations);
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::VectorXd by_shape = place.by_shape.row(axis);
    equations.add_point(place.bone, place.middle, Vector3d::Unit(axis), by_shape, off[axis], weight);
  }
}

void FitTerms::add_centres(const FitData& data, const std::vector<PlacedBone>& placed, bool mirrored,
                           NormalEquations& equations) const {
  constexpr double kNearer = 0.7;  // what is seen of a part lies before its middle, in half widths
  for (std::size_t p = 0; p < data.centres.size(); ++p) {
    if (!data.centres[p]) continue;
    const int part = mirrored ? body_.parts[p].mirror : int(p);
    if (part < 0 || surface_.of_part[part].empty()) continue;
    const PartPlace place = place_of(part, placed);
    const Vector3d surface = place.middle - kNearer * place.half_m * data.centres[p]->normalized();
    add_pull(place, surface - *data.centres[p], double(kCentre_m), equations);
  }
}

void FitTerms::add_middles(const FitData& data, const std::vector<PlacedBone>& placed,
                           NormalEquations& equations) const {
  for (std::size_t p = 0; p < data.middles.size(); ++p) {
    if (surface_.of_part[p].empty()) continue;
    const PartPlace place = place_of(int(p), placed);
    add_pull(place, place.middle - data.middles[p].at.cast<double>(), data.middles[p].sigma_m, equations);
  }
}

void FitTerms::add_outline(const FitData& data, const std::vector<PlacedBone>& placed,
                           NormalEquations& equations) const {
  constexpr std::array kPlaces{0.15, 0.5, 0.85};
  if (!data.silhouette) return;
  const auto weight = double(options_.outline_weight);
  const auto outline = double(options_.outline_m), free = double(options_.free_m);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(flesh_.shapes);
  for (int b = 0; b < flesh_.bone_count(); ++b) {
    const FleshBone& bone = flesh_.bones[b];
    for (const double share : kPlaces) {
      const double along = double(bone.stations.front()) + share * double(bone.stations.back() - bone.stations.front());
      const CrossSection section = section_at(placed[b], bone, along);
      const Vector3d point = placed[b].head + placed[b].global * point_of(bone, placed[b].numbers, section, along);
      const double half = std::min(section.half[0], section.half[1]);
      const Silhouette::Sight sight = data.silhouette->look(point, half);
      if (sight.kind == Silhouette::Sight::Kind::on) {
        const double violation = sight.depth_m - (point.z() - 0.7 * half);
        if (violation <= 0.0) continue;
        const double squared = violation * violation / (free * free);
        const double robust = robust_weight(squared, kLimit, weight, equations);
        equations.add_point(b, point, -Vector3d::UnitZ(), none, violation, robust / (free * free));
      } else if (sight.kind == Silhouette::Sight::Kind::behind) {
        const double scale = point.z() / double(data.silhouette->focal_px());
        const Eigen::Vector2d aside = scale * sight.aside;
        const double squared = aside.squaredNorm() / (outline * outline);
        const double robust = robust_weight(squared, kLimit, weight, equations);
        for (int axis = 0; axis < 2; ++axis) {
          equations.add_point(b, point, -Vector3d::Unit(axis), none, aside[axis], robust / (outline * outline));
        }
      }
    }
  }
}

void FitTerms::add_ground(const Ground& ground, const std::vector<PlacedBone>& placed,
                          NormalEquations& equations) const {
  const double information = 1.0 / (double(options_.ground_m) * double(options_.ground_m));
  const auto pull = [&](const LowPlace& place, double limit) {
    const Eigen::VectorXd by_shape = height_by_shape(ground, place, placed[place.bone], flesh_.bones[place.bone]);
    const double squared = information * place.height_m * place.height_m;
    const double weight = information * robust_weight(squared, limit, 1.0, equations);
    equations.add_point(place.bone, place.at, ground.up, by_shape, place.height_m, weight);
  };
  LowPlace lower_foot;
  for (int b = 0; b < flesh_.bone_count(); ++b) {
    const LowPlace place = low_place(ground, b, placed[b], flesh_.bones[b]);
    if (place.height_m < 0.0) pull(place, kBelowLimit);
    if (std::ranges::find(feet_, b) != feet_.end() && place.height_m < lower_foot.height_m) lower_foot = place;
  }
  // Who sits with raised feet, lies or jumps is beyond the limit and hardly pulled down.
  if (lower_foot.bone >= 0 && lower_foot.height_m > 0.0) pull(lower_foot, kLimit);
}

void FitTerms::add_poses(const BodyState& state, NormalEquations& equations) const {
  for (const LimbPrior& limb : flesh_.limbs) {
    const auto size = static_cast<Index>(3 * limb.bones.size());
    Eigen::VectorXd turns(size);
    for (std::size_t i = 0; i < limb.bones.size(); ++i) {
      turns.segment<3>(static_cast<Index>(3 * i)) = log_rotation(state.local[limb.bones[i]]);
    }
    const LimbPrior::Component* best = nullptr;
    double least = std::numeric_limits<double>::max();
    Eigen::VectorXd whitened(size), of_best(size);
    for (const LimbPrior::Component& component : limb.components) {
      whitened = component.whitening.triangularView<Eigen::Lower>() * (turns - component.mean);
      const double cost = whitened.squaredNorm() - 2.0 * component.log_density;
      if (cost >= least) continue;
      least = cost;
      best = &component;
      of_best = whitened;
    }
    Eigen::MatrixXd derivative = best->whitening;
    for (std::size_t i = 0; i < limb.bones.size(); ++i) {
      const auto at = static_cast<Index>(3 * i);
      derivative.middleCols<3>(at) = (derivative.middleCols<3>(at) * log_by_turn(turns.segment<3>(at))).eval();
    }
    const auto weight = double(options_.pose_weight);
    equations.add_turns(limb.bones, derivative, of_best, weight);
    equations.add_cost(-2.0 * weight * best->log_density);
  }
}

void FitTerms::add_limits(const BodyState& state, NormalEquations& equations) const {
  const auto sigma = double(kBeyond_rad);
  for (int b = 0; b < flesh_.bone_count(); ++b) {
    const FleshBone& bone = flesh_.bones[b];
    if (bone.parent < 0) continue;
    const Vector3d turn = log_rotation(state.local[b]);
    Vector3d beyond = Vector3d::Zero();
    for (int i = 0; i < 3; ++i) {
      beyond[i] = turn[i] - std::clamp(turn[i], double(bone.low[i]), double(bone.high[i]));
    }
    if (beyond.isZero()) continue;
    Eigen::Matrix3d derivative = log_by_turn(turn);
    for (int i = 0; i < 3; ++i) {
      if (beyond[i] == 0.0) derivative.row(i).setZero();
    }
    equations.add_turns({b}, derivative, beyond, 1.0 / (sigma * sigma));
  }
}

void FitTerms::add_followed(const ExpectedBody& expected, const BodyState& state, NormalEquations& equations) const {
  if (!expected.pose) return;
  const double metres = double(options_.follow_m) * expected.loosened;
  const double radians = double(kFollow_rad) * expected.loosened;
  for (int axis = 0; axis < 3; ++axis) {
    equations.add_single(StateLayout::root() + axis, 1.0, state.root[axis] - expected.pose->root[axis],
                         1.0 / (metres * metres));
  }
  for (int b = 0; b < flesh_.bone_count(); ++b) {
    const Vector3d turn = log_rotation(expected.pose->local[b].conjugate() * state.local[b]);
    const double squared = turn.squaredNorm() / (radians * radians);
    const double robust = robust_weight(squared, kLimit, 1.0, equations);
    equations.add_turns({b}, log_by_turn(turn), turn, robust / (radians * radians));
  }
}

void FitTerms::add_priors(const ExpectedBody& expected, const BodyState& state, NormalEquations& equations) const {
  add_poses(state, equations);
  add_limits(state, equations);
  equations.add_shape(double(options_.shape_weight) * expected.shape_information, state.shape - expected.shape);
}

void FitTerms::evaluate_points(const FitData& data, const BodyState& state, const std::vector<Assigned>& assigned,
                               std::vector<PlacedBone>& placed, NormalEquations& equations) const {
  placed = place_bones(flesh_, state);
  equations.clear(placed);
  add_points(data, placed, assigned, equations);
  add_middles(data, placed, equations);
  add_outline(data, placed, equations);
  if (data.expected.ground) add_ground(*data.expected.ground, placed, equations);
  add_priors(data.expected, state, equations);
  add_followed(data.expected, state, equations);
  equations.finish();
}

void FitTerms::evaluate_centres(const FitData& data, const BodyState& state, bool mirrored,
                                std::vector<PlacedBone>& placed, NormalEquations& equations) const {
  placed = place_bones(flesh_, state);
  equations.clear(placed);
  add_centres(data, placed, mirrored, equations);
  if (data.expected.ground) add_ground(*data.expected.ground, placed, equations);
  add_priors(data.expected, state, equations);
  equations.finish();
}

std::vector<FitTerms::Support> FitTerms::support(const FitData& data, const std::vector<PlacedBone>& placed,
                                                 const std::vector<Assigned>& assigned) const {
  std::vector<Support> support(flesh_.bones.size());
  const double most = kOutlier * kOutlier;
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    const int b = assigned[i].stretch.bone;
    if (b < 0) continue;
    const Hit hit = this->hit(placed[b], b, assigned[i].stretch, data.points[i].at.cast<double>());
    ++support[b].points;
    support[b].misfit += hit.cost;
    if (hit.squared < most) ++support[b].on;
  }
  for (Support& of_bone : support) of_bone.misfit /= std::max(1, of_bone.points);
  return support;
}

}  // namespace vesalius
