#include "synth/scene/occupancy.h"

#include <algorithm>

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

constexpr float kSampledSink_m = 0.025F;  ///< below kMaxSink_m, since the sampled points may miss the deepest one
constexpr float kEyeClear_m = 0.2F;

/// Half the thickness of the flesh around each bone as a share of the stature, in the order of `Bone`. The values are
/// those of a slim adult, so that clothes may touch.
constexpr std::array<float, kBoneCount> kFlesh = {0.065F, 0.06F,  0.065F, 0.03F,  0.05F, 0.03F,  0.024F,
                                                  0.02F,  0.015F, 0.03F,  0.024F, 0.02F, 0.015F, 0.038F,
                                                  0.027F, 0.02F,  0.038F, 0.027F, 0.02F};

float allowed_sink(const OrientedBox& box) { return std::min(kSampledSink_m, 0.6F * box.half.minCoeff()); }

Eigen::AlignedBox3f bounds_of(const OrientedBox& box) {
  const Vector3f reach = box.pose.linear().cwiseAbs() * box.half;
  return {box.pose.translation() - reach, box.pose.translation() + reach};
}

/// Returns the smallest distance between two segments (Ericson, Real-Time Collision Detection, 5.1.9).
float distance(const Capsule& a, const Capsule& b) {
  const Vector3f d1 = a.to - a.from, d2 = b.to - b.from, r = a.from - b.from;
  const float aa = d1.squaredNorm(), ee = d2.squaredNorm(), f = d2.dot(r), c = d1.dot(r), bb = d1.dot(d2);
  constexpr float kPoint = 1e-8F;
  float s = 0.F, t = 0.F;
  if (aa > kPoint && ee > kPoint) {
    const float denominator = aa * ee - bb * bb;
    s = denominator > 1e-10F ? std::clamp((bb * f - c * ee) / denominator, 0.F, 1.F) : 0.F;
    t = (bb * s + f) / ee;
    if (t < 0.F || t > 1.F) {
      t = std::clamp(t, 0.F, 1.F);
      s = std::clamp((bb * t - c) / aa, 0.F, 1.F);
    }
  } else if (aa > kPoint) {
    s = std::clamp(-c / aa, 0.F, 1.F);
  } else if (ee > kPoint) {
    t = std::clamp(f / ee, 0.F, 1.F);
  }
  return (a.from + s * d1 - b.from - t * d2).norm();
}

}  // namespace

BodyOutline outline_of(const PosedBody& body, float stature_m, std::size_t stride) {
  constexpr std::size_t kFine = 12000;  // vertices of bodies so fine that some can be left out
  BodyOutline outline;
  stride = std::max<std::size_t>(1, stride * std::min(body.vertices.size(), kFine) / kFine);
  outline.points.reserve(body.vertices.size() / stride + 1);
  for (std::size_t i = 0; i < body.vertices.size(); i += stride) outline.points.push_back(body.vertices[i]);
  for (const Vector3f& p : body.vertices) outline.bounds.extend(p);
  for (std::size_t b = 0; b < kBoneCount; ++b) {
    outline.bones[b] = {body.joints[b], body.ends[b], kFlesh[b] * stature_m};
  }
  return outline;
}

BodyOutline moved(BodyOutline outline, const Eigen::Isometry3f& motion) {
  for (Vector3f& p : outline.points) p = motion * p;
  for (Capsule& bone : outline.bones) bone = {motion * bone.from, motion * bone.to, bone.radius_m};
  outline.bounds = outline.bounds.transformed(motion);
  return outline;
}

bool sinks_in(const BodyOutline& body, const std::vector<OrientedBox>& solids) {
  return std::ranges::any_of(solids, [&](const OrientedBox& box) {
    if (!bounds_of(box).intersects(body.bounds)) return false;
    const float allowed = allowed_sink(box);
    return std::ranges::any_of(body.points, [&](const Vector3f& p) { return depth_inside(box, p) > allowed; });
  });
}

bool sinks_in(const BodyOutline& a, const BodyOutline& b) {
  if (!a.bounds.intersects(b.bounds)) return false;
  for (const Capsule& one : a.bones) {
    for (const Capsule& other : b.bones) {
      if (distance(one, other) < one.radius_m + other.radius_m) return true;
    }
  }
  return false;
}

bool Occupancy::near_an_eye(const BodyOutline& body) const {
  return std::ranges::any_of(eyes_, [&](const Vector3f& eye) {
    if (body.bounds.squaredExteriorDistance(eye) > kEyeClear_m * kEyeClear_m) return false;
    return std::ranges::any_of(body.points, [&](const Vector3f& p) { return (p - eye).norm() <= kEyeClear_m; });
  });
}

bool Occupancy::free_for(const BodyOutline& body) const {
  if (sinks_in(body, solids_)) return false;
  for (const std::vector<BodyOutline>& person : bodies_) {
    if (std::ranges::any_of(person, [&](const BodyOutline& other) { return sinks_in(body, other); })) return false;
  }
  return !near_an_eye(body);
}

bool Occupancy::free_for(const std::vector<OrientedBox>& solids) const {
  constexpr float kTouching_m = 0.005F;
  for (const OrientedBox& box : solids) {
    OrientedBox wide = box;
    wide.half.array() += kEyeClear_m;
    if (std::ranges::any_of(eyes_, [&](const Vector3f& eye) { return depth_inside(wide, eye) > 0.F; })) return false;
    for (const Vector3f& corner : corners(box)) {
      if (clearance(room_, corner) < -1e-3F) return false;
    }
    for (const OrientedBox& other : solids_) {
      const float reach = box.radius() + other.radius();
      if ((box.pose.translation() - other.pose.translation()).squaredNorm() > reach * reach) continue;
      if (overlap(box, other, kTouching_m)) return false;
    }
  }
  return std::ranges::none_of(bodies_, [&](const std::vector<BodyOutline>& person) {
    return std::ranges::any_of(person, [&](const BodyOutline& body) { return sinks_in(body, solids); });
  });
}

float Occupancy::hidden_share(const std::vector<OrientedBox>& solids) const {
  const Vector3f& eye = eyes_.front();
  float largest = 0.F;
  for (const std::vector<BodyOutline>& person : bodies_) {
    int hidden = 0;
    for (const BodyOutline& body : person) {
      for (const Capsule& bone : body.bones) {
        const Vector3f middle = 0.5F * (bone.from + bone.to);
        hidden += std::ranges::any_of(solids, [&](const OrientedBox& box) { return blocks(box, eye, middle); }) ? 1 : 0;
      }
    }
    largest = std::max(largest, float(hidden) / float(kBoneCount * person.size()));
  }
  return largest;
}

}  // namespace vesalius::synth
