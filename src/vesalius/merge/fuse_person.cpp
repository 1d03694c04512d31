#include "vesalius/merge/fuse_person.h"

#include <algorithm>
#include <cmath>

#include "vesalius/merge/joint_spread.h"

namespace vesalius {
namespace {

using Eigen::Vector3f;

constexpr float kWrongSigmas = 2.F;  // standard deviations of two places beyond which one of them is wrong
constexpr float kPredicted = 4.F;    // by which a variance grows: predictions that err do so by more than others

/// A place as one camera knows it.
struct Known {
  State state = State::none;
  Vector3f at;
  float confidence = 0.F;

  float variance() const {
    const float sigma = sigma_of(confidence);
    return sigma * sigma * (state == State::predicted ? kPredicted : 1.F);
  }
};

bool is_wrong_beside(const Known& sure, const Known& other) {
  const float variance = sure.variance() + other.variance() + kJointBias_m * kJointBias_m;
  return (sure.at - other.at).squaredNorm() > kWrongSigmas * kWrongSigmas * variance;
}

/// Returns the mean of places; state none for none.
Known mean_of(std::vector<Known> places) {
  std::erase_if(places, [](const Known& place) { return place.state == State::none; });
  if (places.empty()) return {};
  const Known sure = *std::ranges::min_element(places, {}, &Known::variance);
  Known mean = sure;
  float weights = 0.F;
  Vector3f sum = Vector3f::Zero();
  for (const Known& place : places) {
    if (is_wrong_beside(sure, place)) continue;
    const float weight = 1.F / place.variance();
    weights += weight;
    sum += weight * place.at;
    mean.confidence = std::max(mean.confidence, place.confidence);
    if (place.state == State::observed) mean.state = State::observed;
  }
  mean.at = sum / weights;
  mean.confidence = std::max(mean.confidence, confidence_of(std::sqrt(1.F / weights)));
  return mean;
}

/// Fuses the joints that `joints_of` gives for each.
template <class JointsOf>
void fuse_joints(const std::vector<const TrackedPerson*>& seen, const JointsOf& joints_of,
                 std::vector<std::vector<Joint>>& fused) {
  for (std::size_t s = 0; s < fused.size(); ++s) {
    for (std::size_t j = 0; j < fused[s].size(); ++j) {
      std::vector<Known> places;
      for (const TrackedPerson* person : seen) {
        const std::vector<std::vector<Joint>>& joints = joints_of(*person);
        if (joints.size() == fused.size())
          places.push_back({joints[s][j].state, joints[s][j].position, joints[s][j].confidence});
      }
      const Known mean = mean_of(std::move(places));
      Joint& joint = fused[s][j];
      joint.unseen = Unseen::none;
      joint.behind = -1;
      if (mean.state == State::none) continue;
      joint.state = mean.state;
      joint.position = mean.at;
      joint.confidence = mean.confidence;
    }
  }
}

void fuse_parts(const std::vector<const TrackedPerson*>& seen, Skeleton& skeleton) {
  skeleton.found = 0;
  for (std::size_t p = 0; p < skeleton.parts.size(); ++p) {
    std::vector<Known> places;
    for (const TrackedPerson* person : seen) {
      const SkeletonPart& part = person->person.skeleton.parts[p];
      places.push_back({part.state, part.centre, part.confidence});
    }
    const Known mean = mean_of(std::move(places));
    SkeletonPart& part = skeleton.parts[p];
    if (mean.state != State::none) {
      part.state = mean.state;
      part.centre = mean.at;
      part.confidence = mean.confidence;
    }
    part.unseen = Unseen::none;
    part.behind = -1;
    skeleton.found += part.state == State::observed ? 1 : 0;
  }
}

}  // namespace

TrackedPerson fuse_person(const std::vector<const TrackedPerson*>& seen) {
  TrackedPerson fused = *seen.front();
  if (seen.size() == 1) return fused;
  const auto of_frame = [](const TrackedPerson& person) -> const auto& { return person.person.joints; };
  const auto smoothed = [](const TrackedPerson& person) -> const auto& { return person.smoothed; };
  fuse_joints(seen, of_frame, fused.person.joints);
  fuse_joints(seen, smoothed, fused.smoothed);
  fuse_parts(seen, fused.person.skeleton);
  return fused;
}

}  // namespace vesalius
