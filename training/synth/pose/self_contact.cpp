#include "synth/pose/self_contact.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "synth/pose/stick_figure.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

/// The region of a capsule. Capsules of one region are never compared, nor are those of neighbouring regions.
enum class Region : std::uint8_t {
  hips,
  waist,
  chest,
  head,
  l_upper_arm,
  l_lower_arm,
  r_upper_arm,
  r_lower_arm,
  l_thigh,
  l_lower_leg,
  r_thigh,
  r_lower_leg
};

/// A rounded piece of the body from one point of a bone to another, in the bone's rest frame, metres.
struct Shape {
  Region region;
  Bone bone;
  std::array<float, 3> from, to;
  float radius;
};

// These are the sizes of a slim adult 1.72 m tall, measured along the bones' rest directions. The trunk consists of
// capsules that lie across, since it is wider than deep. Thighs and upper arms begin below the joint, where they leave
// the trunk.
constexpr std::array<Shape, 25> kShapes{{
    {Region::hips, Bone::pelvis, {-0.07F, 0.02F, -0.02F}, {0.07F, 0.02F, -0.02F}, 0.105F},
    {Region::waist, Bone::spine, {-0.05F, 0.06F, 0.F}, {0.05F, 0.06F, 0.F}, 0.095F},
    {Region::chest, Bone::chest, {-0.06F, 0.03F, 0.F}, {0.06F, 0.03F, 0.F}, 0.10F},
    {Region::chest, Bone::chest, {-0.08F, 0.12F, 0.F}, {0.08F, 0.12F, 0.F}, 0.095F},
    {Region::head, Bone::neck, {0.F, 0.04F, 0.F}, {0.F, 0.08F, 0.F}, 0.05F},
    {Region::head, Bone::head, {0.F, 0.06F, 0.015F}, {0.F, 0.13F, 0.01F}, 0.085F},
    {Region::l_upper_arm, Bone::l_upper_arm, {0.12F, 0.F, 0.F}, {0.31F, 0.F, 0.F}, 0.042F},
    {Region::l_lower_arm, Bone::l_forearm, {0.03F, 0.F, 0.F}, {0.24F, 0.F, 0.F}, 0.035F},
    {Region::l_lower_arm, Bone::l_hand, {0.02F, 0.F, 0.02F}, {0.10F, 0.F, 0.02F}, 0.02F},
    {Region::l_lower_arm, Bone::l_hand, {0.02F, 0.F, -0.02F}, {0.10F, 0.F, -0.02F}, 0.02F},
    {Region::r_upper_arm, Bone::r_upper_arm, {-0.12F, 0.F, 0.F}, {-0.31F, 0.F, 0.F}, 0.042F},
    {Region::r_lower_arm, Bone::r_forearm, {-0.03F, 0.F, 0.F}, {-0.24F, 0.F, 0.F}, 0.035F},
    {Region::r_lower_arm, Bone::r_hand, {-0.02F, 0.F, 0.02F}, {-0.10F, 0.F, 0.02F}, 0.02F},
    {Region::r_lower_arm, Bone::r_hand, {-0.02F, 0.F, -0.02F}, {-0.10F, 0.F, -0.02F}, 0.02F},
    {Region::l_thigh, Bone::l_thigh, {0.F, -0.16F, 0.F}, {0.F, -0.28F, 0.F}, 0.07F},
    {Region::l_thigh, Bone::l_thigh, {0.F, -0.28F, 0.F}, {0.F, -0.42F, 0.F}, 0.055F},
    {Region::l_lower_leg, Bone::l_shin, {0.F, -0.04F, 0.F}, {0.F, -0.25F, -0.01F}, 0.05F},
    {Region::l_lower_leg, Bone::l_shin, {0.F, -0.25F, 0.F}, {0.F, -0.42F, 0.F}, 0.04F},
    {Region::l_lower_leg, Bone::l_foot, {0.F, -0.03F, -0.03F}, {0.F, -0.04F, 0.17F}, 0.035F},
    {Region::r_thigh, Bone::r_thigh, {0.F, -0.16F, 0.F}, {0.F, -0.28F, 0.F}, 0.07F},
    {Region::r_thigh, Bone::r_thigh, {0.F, -0.28F, 0.F}, {0.F, -0.42F, 0.F}, 0.055F},
    {Region::r_lower_leg, Bone::r_shin, {0.F, -0.04F, 0.F}, {0.F, -0.25F, -0.01F}, 0.05F},
    {Region::r_lower_leg, Bone::r_shin, {0.F, -0.25F, 0.F}, {0.F, -0.42F, 0.F}, 0.04F},
    {Region::r_lower_leg, Bone::r_foot, {0.F, -0.03F, -0.03F}, {0.F, -0.04F, 0.17F}, 0.035F},
    {Region::head, Bone::head, {0.F, 0.02F, 0.05F}, {0.F, 0.06F, 0.06F}, 0.05F},
}};

/// Returns whether two regions meet in a joint or fold onto each other, so that contact between them is normal.
bool neighbours(Region a, Region b) {
  if (a > b) std::swap(a, b);
  if (a == b) return true;
  const auto is = [&](Region x, Region y) { return a == x && b == y; };
  const bool trunk = b <= Region::head;
  const bool arm = is(Region::l_upper_arm, Region::l_lower_arm) || is(Region::r_upper_arm, Region::r_lower_arm);
  const bool leg = is(Region::l_thigh, Region::l_lower_leg) || is(Region::r_thigh, Region::r_lower_leg);
  const bool shoulder = a == Region::chest && (b == Region::l_upper_arm || b == Region::r_upper_arm);
  const bool hip = a == Region::hips && (b == Region::l_thigh || b == Region::r_thigh);
  return trunk || arm || leg || shoulder || hip;
}

using Pair = std::pair<std::size_t, std::size_t>;

const std::vector<Pair>& compared_pairs() {
  static const std::vector<Pair> pairs = [] {
    std::vector<Pair> out;
    for (std::size_t i = 0; i < kShapes.size(); ++i) {
      for (std::size_t j = i + 1; j < kShapes.size(); ++j) {
        if (!neighbours(kShapes[i].region, kShapes[j].region)) out.emplace_back(i, j);
      }
    }
    return out;
  }();
  return pairs;
}

struct Segment {
  Vector3f from;
  Vector3f to;
};

/// Returns the distance between two segments (Ericson, "Real-Time Collision Detection", section 5.1.9).
float distance(const Segment& first, const Segment& second) {
  const Vector3f d1 = first.to - first.from, d2 = second.to - second.from, r = first.from - second.from;
  const float a = d1.squaredNorm(), e = d2.squaredNorm(), f = d2.dot(r), c = d1.dot(r), b = d1.dot(d2);
  const float denominator = a * e - b * b;
  float s = denominator > 1e-12F ? std::clamp((b * f - c * e) / denominator, 0.F, 1.F) : 0.F;
  float t = (b * s + f) / e;
  if (t < 0.F || t > 1.F) {
    t = std::clamp(t, 0.F, 1.F);
    s = std::clamp((b * t - c) / a, 0.F, 1.F);
  }
  return (first.from + d1 * s - second.from - d2 * t).norm();
}

}  // namespace

float self_overlap_m(const Pose& pose) {
  const StickFigure figure = stick_figure(pose);
  const auto world = world_rotations(pose);
  std::array<Segment, kShapes.size()> segments;
  for (std::size_t i = 0; i < kShapes.size(); ++i) {
    const auto bone = static_cast<std::size_t>(kShapes[i].bone);
    const auto place = [&](const std::array<float, 3>& p) {
      return (figure.head[bone] + world[bone] * Vector3f(p[0], p[1], p[2])).eval();
    };
    segments[i] = {place(kShapes[i].from), place(kShapes[i].to)};
  }
  float deepest = std::numeric_limits<float>::lowest();
  for (const auto& [i, j] : compared_pairs()) {
    deepest = std::max(deepest, kShapes[i].radius + kShapes[j].radius - distance(segments[i], segments[j]));
  }
  return deepest;
}

bool intersects_itself(const Pose& pose) { return self_overlap_m(pose) > kTouch_m; }

}  // namespace vesalius::synth
