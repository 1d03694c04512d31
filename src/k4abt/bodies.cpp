#include "k4abt/bodies.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "vesalius/fit/flesh_joints.h"

namespace vesalius::k4abt {
namespace {

constexpr float kLeastProbability = 0.5F;  ///< of K4ABT_JOINT_CONFIDENCE_MEDIUM

/// The joint before each towards the pelvis, as Azure Kinect's documentation has them.
constexpr std::array<int, K4ABT_JOINT_COUNT> kParents{-1, 0,  1, 2,  2,  4,  5, 6,  7,  8,  7, 2,  11, 12, 13, 14,
                                                      15, 14, 0, 18, 19, 20, 0, 22, 23, 24, 3, 26, 26, 26, 26, 26};

k4a_float3_t millimetres(const Eigen::Vector3f& metres) {
  k4a_float3_t place;
  place.xyz = {1000.F * metres.x(), 1000.F * metres.y(), 1000.F * metres.z()};
  return place;
}

k4a_quaternion_t to_quaternion(const Eigen::Quaternionf& rotation) {
  k4a_quaternion_t quaternion;
  quaternion.wxyz = {rotation.w(), rotation.x(), rotation.y(), rotation.z()};
  return quaternion;
}

}  // namespace

k4abt_body_t to_body(const TrackedPerson& person, const std::vector<Joint>& joints, const JointSet& set) {
  const auto rotations = rotations_of(person, set);
  k4abt_body_t body{};
  body.id = static_cast<std::uint32_t>(person.id);
  for (std::size_t j = 0; j < K4ABT_JOINT_COUNT; ++j) {
    k4abt_joint_t& to = body.skeleton.joints[j];
    if (kParents[j] >= 0) {
      to = body.skeleton.joints[kParents[j]];
    } else {
      to.position = millimetres(person.position);
      to.orientation = to_quaternion(Eigen::Quaternionf::Identity());
    }
    to.confidence_level = K4ABT_JOINT_CONFIDENCE_NONE;
    if (rotations[j]) to.orientation = to_quaternion(*rotations[j]);
    if (joints[j].state == State::none) continue;
    to.position = millimetres(joints[j].position);
    to.confidence_level =
        joints[j].confidence < kLeastProbability ? K4ABT_JOINT_CONFIDENCE_LOW : K4ABT_JOINT_CONFIDENCE_MEDIUM;
  }
  return body;
}

}  // namespace vesalius::k4abt
