#include "vesalius/track/trunk_place.h"

#include <string>

namespace vesalius {
namespace {

constexpr float kTrunkSigma_m = 0.06F;   // of the mean of seen parts of the trunk, at one metre
constexpr float kPartsSigma_m = 0.25F;   // of the mean of whatever parts are seen
constexpr float kPointsSigma_m = 0.35F;  // of the mean of the mask's points
constexpr float kSigmaPerZ2 = 0.005F;

/// A mean that leaves out what is not finite.
struct Mean {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  long count = 0;

  void add(const Eigen::Vector3f& point) {
    if (!point.allFinite()) return;
    sum += point.cast<double>();
    ++count;
  }
  Eigen::Vector3f value() const { return (sum / double(count)).cast<float>(); }
};

TrunkPlace placed(const Eigen::Vector3f& position, float sigma_m) {
  return {position, sigma_m + kSigmaPerZ2 * position.z() * position.z()};
}

/// Mean of the known parts whose names end so, such as l_chest and r_chest.
Mean mean_of(const Skeleton& skeleton, const BodyModel& body, const char* ending, int& seen) {
  Mean mean;
  for (int p = 0; p < body.part_count(); ++p) {
    const SkeletonPart& part = skeleton.parts[p];
    if (part.state == State::none || !body.parts[p].name.ends_with(ending)) continue;
    mean.add(part.centre);
    seen += part.state == State::observed ? 1 : 0;
  }
  return mean;
}

Mean mean_of_points(const Person& person, const Frame& frame) {
  Mean mean;
  if (!person.mask.same_size(frame.depth)) return mean;
  for (int v = person.box.v; v < person.box.v + person.box.height; ++v) {
    for (int u = person.box.u; u < person.box.u + person.box.width; ++u) {
      if (person.mask(u, v) != 0 && frame.depth(u, v) != 0) mean.add(point_at(frame.camera, frame.depth, u, v));
    }
  }
  return mean;
}

}  // namespace

std::optional<TrunkPlace> trunk_place(const Person& person, const Frame& frame, const BodyModel& body) {
  int seen = 0;
  const Mean chest = mean_of(person.skeleton, body, "chest", seen), hips = mean_of(person.skeleton, body, "hips", seen);
  if (chest.count > 0 && hips.count > 0 && seen > 0) {
    // What is predicted from the other end is less certain.
    const float unseen = seen > 2 ? 1.F : 2.F;
    return placed(0.5F * (chest.value() + hips.value()), unseen * kTrunkSigma_m);
  }
  Mean parts;
  for (const SkeletonPart& part : person.skeleton.parts) {
    if (part.state == State::observed) parts.add(part.centre);
  }
  if (parts.count > 0) return placed(parts.value(), kPartsSigma_m);
  const Mean points = mean_of_points(person, frame);
  if (points.count > 0) return placed(points.value(), kPointsSigma_m);
  return std::nullopt;
}

}  // namespace vesalius
