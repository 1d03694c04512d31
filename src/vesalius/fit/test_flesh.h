#pragma once

// What tests of fitted bodies share: people made of the flesh model itself, as a camera sees them.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "vesalius/base/random.h"
#include "vesalius/body_model.h"
#include "vesalius/fit/body_state.h"
#include "vesalius/fit/flesh_model.h"
#include "vesalius/forest/person_points.h"
#include "vesalius/frame.h"
#include "vesalius/person.h"

namespace vesalius::test {

/// Returns the rotation of a body that stands upright: yaw 0 faces the camera, pi turns the back to it.
inline Eigen::Quaterniond upright(double yaw_rad) {
  return Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()) *
         Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitY());
}

/// Returns the body of mean shape in the most usual pose of every limb, 2.5 m before the camera.
inline BodyState usual_state(double yaw_rad, const FleshModel& flesh = builtin_flesh()) {
  BodyState state;
  state.root = {0.1, 0.1, 2.5};
  state.shape = Eigen::VectorXd::Zero(flesh.shapes);
  state.local.assign(flesh.bones.size(), Eigen::Quaterniond::Identity());
  for (const LimbPrior& limb : flesh.limbs) {
    for (std::size_t i = 0; i < limb.bones.size(); ++i) {
      const Eigen::Vector3d turn = limb.components.front().mean.segment<3>(static_cast<Eigen::Index>(3 * i));
      state.local[limb.bones[i]] = exp_rotation(turn);
    }
  }
  state.local[0] = upright(yaw_rad);
  return state;
}

/// Turns a bone about its own axes.
inline void turn(BodyState& state, const char* bone, const Eigen::Vector3d& by,
                 const FleshModel& flesh = builtin_flesh()) {
  Eigen::Quaterniond& local = state.local[flesh.find_bone(bone)];
  local = local * exp_rotation(by);
}

/// Returns a state with every bone turned and the shape changed at random.
inline BodyState random_state(std::uint64_t seed, double spread, const FleshModel& flesh = builtin_flesh()) {
  Random random(seed);
  BodyState state = usual_state(0.7, flesh);
  for (Eigen::Quaterniond& local : state.local) {
    const double x = random.normal(0.0, spread), y = random.normal(0.0, spread), z = random.normal(0.0, spread);
    local = local * exp_rotation({x, y, z});
  }
  for (double& number : state.shape) number = random.normal(0.0, 1.0);
  return state;
}

/// A person before a wall, and where the bones truly are.
struct SeenBody {
  Frame frame;
  Person person;
  std::vector<PlacedBone> truth;
};

/// Returns the part of a place on a bone by the body model's own rules, or kBackground.
inline std::uint8_t part_of(const BodyModel& body, const std::string& bone, double along, double x) {
  const double place = std::clamp(along, 0.0, 1.0);
  for (const SurfaceRule& rule : body.surface) {
    if (rule.bone != bone || place < static_cast<double>(rule.from) || place > static_cast<double>(rule.to)) continue;
    if (rule.side == SurfaceRule::Side::left && x < 0.0) continue;
    if (rule.side == SurfaceRule::Side::right && x > 0.0) continue;
    return static_cast<std::uint8_t>(rule.part);
  }
  return kBackground;
}

/// Draws the flesh of a bone into depth and labels, point by point, the nearest first.
inline void draw_bone(const FleshBone& bone, const PlacedBone& placed, const BodyModel& body, Frame& frame,
                      LabelImage& labels) {
  constexpr int kAlong = 70, kAround = 110;
  const std::array<int, 2> across = axes_across(bone.axis);
  const double length = placed.numbers[3 + bone.axis];
  for (int i = 0; i <= kAlong; ++i) {
    const double first = static_cast<double>(bone.stations.front()), last = static_cast<double>(bone.stations.back());
    const double middle = static_cast<double>(bone.stations[1]);
    // Half a circle at both ends rounds them; between them the stations' ellipses are joined by straight lines.
    const double t = 1.6 * i / kAlong - 0.3;
    const double inside = first + (last - first) * std::clamp(t, 0.0, 1.0);
    const double over = std::clamp(t < 0.0 ? t / 0.3 : t > 1.0 ? (t - 1.0) / 0.3 : 0.0, -1.0, 1.0);
    const int low = inside > middle ? 1 : 0;
    const double from = static_cast<double>(bone.stations[low]), to = static_cast<double>(bone.stations[low + 1]);
    const double share = (inside - from) / (to - from);
    std::array<double, 4> section{};
    for (int n = 0; n < 4; ++n) {
      section[n] = (1.0 - share) * placed.numbers[6 + 4 * low + n] + share * placed.numbers[10 + 4 * low + n];
    }
    const double cap = std::min(section[2], section[3]);
    const double along = inside + over * cap / std::abs(length);
    const double round = std::sqrt(1.0 - over * over);
    for (int a = 0; a < kAround; ++a) {
      const double angle = 2.0 * std::numbers::pi * a / kAround;
      Eigen::Vector3d q;
      q[bone.axis] = along * length;
      q[across[0]] = section[0] + round * section[2] * std::cos(angle);
      q[across[1]] = section[1] + round * section[3] * std::sin(angle);
      const Eigen::Vector3d at = placed.head + placed.global * q;
      if (at.z() < 0.2) continue;
      const Eigen::Vector2f pixel = frame.camera.pixel(at.cast<float>());
      const int u = static_cast<int>(std::lround(pixel.x())), v = static_cast<int>(std::lround(pixel.y()));
      const std::uint8_t part = part_of(body, bone.name, along, q.x());
      if (!frame.depth.contains(u, v) || part == kBackground) continue;
      const auto depth_mm = static_cast<std::uint16_t>(std::lround(1000.0 * at.z()));
      if (depth_mm >= frame.depth(u, v)) continue;
      frame.depth(u, v) = depth_mm;
      labels(u, v) = part;
    }
  }
}

/// Fills in what detection would tell of a person with these labels.
inline void describe(const BodyModel& body, const Frame& frame, Person& person) {
  constexpr int kLeastPixels = 12;
  const int parts = body.part_count();
  person.mask = Mask(frame.depth.width(), frame.depth.height());
  Posteriors posteriors{
      .width = frame.depth.width(), .height = frame.depth.height(), .classes = parts, .whole = 255, .sums = {}};
  posteriors.sums.assign(frame.depth.size() * static_cast<std::size_t>(parts), 0);
  std::vector<Eigen::Vector3f> sums(parts, Eigen::Vector3f::Zero());
  std::vector<int> counts(parts, 0);
  for (int v = 0; v < frame.depth.height(); ++v) {
    for (int u = 0; u < frame.depth.width(); ++u) {
      const std::uint8_t part = person.labels(u, v);
      if (part == kBackground) continue;
      person.mask(u, v) = 1;
      posteriors.at(u, v)[part] = 255;
      sums[part] += point_at(frame.camera, frame.depth, u, v);
      ++counts[part];
    }
  }
  person.box = bounding_box(person.mask);
  person.skeleton.parts.assign(parts, {});
  for (int p = 0; p < parts; ++p) {
    if (counts[p] < kLeastPixels) continue;
    person.skeleton.parts[p].state = State::observed;
    person.skeleton.parts[p].centre = sums[p] / static_cast<float>(counts[p]);
  }
  person.points = sample_points(frame.depth, frame.camera, person.labels, person.box, posteriors,
                                {0, 0, frame.depth.width(), frame.depth.height()}, parts);
}

/// Gives a point the label of the body's other side.
inline void mirror_label(PersonPoint& point, const BodyModel& body = paper_body()) {
  point.part.front() = static_cast<std::uint8_t>(body.parts[point.part.front()].mirror);
}

/// Returns what a camera sees of a body: exact depth and labels.
inline SeenBody see(const BodyState& state, const BodyModel& body = paper_body(),
                    const FleshModel& flesh = builtin_flesh()) {
  constexpr std::uint16_t kWall_mm = 4500;
  SeenBody seen;
  seen.truth = place_bones(flesh, state);
  seen.frame.name = "body";
  seen.frame.camera = {200, 200, 180.F, 180.F, 99.5F, 99.5F};
  seen.frame.depth = DepthImage(200, 200, kWall_mm);
  seen.person.labels = LabelImage(200, 200, kBackground);
  for (int b = 0; b < flesh.bone_count(); ++b) {
    draw_bone(flesh.bones[b], seen.truth[b], body, seen.frame, seen.person.labels);
  }
  describe(body, seen.frame, seen.person);
  return seen;
}

}  // namespace vesalius::test
