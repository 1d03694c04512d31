#include "vesalius/derive_joints.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vesalius/base/body_heading.h"
#include "vesalius/predict_parts.h"

namespace vesalius {
namespace {

constexpr float kLeastWeight = 0.5F;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

}  // namespace

std::vector<Eigen::Vector3f> given_centres(const Skeleton& skeleton) {
  std::vector<Eigen::Vector3f> centres;
  for (const SkeletonPart& part : skeleton.parts) {
    centres.push_back(part.state != State::none ? part.centre : Eigen::Vector3f::Constant(kNaN));
  }
  return centres;
}

Joint derive_joint(const JointDefinition& definition, const Skeleton& skeleton, const Eigen::Vector3f& up) {
  Joint joint{State::none, Eigen::Vector3f::Constant(kNaN), 0.F};
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  float weight = 0.F;
  float confidence = 0.F, whole = 0.F;
  bool all_observed = true;
  for (std::size_t i = 0; i < definition.parts.size(); ++i) {
    const SkeletonPart& part = skeleton.parts[definition.parts[i]];
    const float influence = std::abs(definition.weights[i]);
    whole += influence;
    if (part.state == State::none) {
      all_observed = false;
      continue;
    }
    all_observed = all_observed && part.state == State::observed;
    sum += definition.weights[i] * part.centre;
    weight += definition.weights[i];
    confidence += influence * part.confidence;
  }
  if (definition.parts.empty() || weight < kLeastWeight) return joint;
  const Eigen::Vector3f surface = sum / weight;
  joint.position = surface + definition.depth_offset_m * surface.normalized() + definition.up_offset_m * up;
  joint.confidence = std::clamp(confidence / whole, 0.F, 1.F);  // missing parts lower it
  joint.state = all_observed ? State::observed : State::predicted;
  return joint;
}

std::vector<std::vector<Joint>> derive_joints(const BodyModel& body, const Skeleton& skeleton) {
  const Skeleton drawn = drawn_to_votes(body.distribution, skeleton);
  const Eigen::Vector3f up = body_up(given_centres(drawn), body);
  std::vector<std::vector<Joint>> sets;
  for (const JointSet& set : body.joint_sets) {
    std::vector<Joint>& joints = sets.emplace_back();
    for (const JointDefinition& definition : set.joints) joints.push_back(derive_joint(definition, drawn, up));
  }
  return sets;
}

}  // namespace vesalius
