#include "nite2/pose.h"

#include <algorithm>
#include <cmath>

namespace vesalius::nite2 {
namespace {

constexpr float kLeastConfidence = 0.5F;
constexpr float kLevel = 0.5F;    ///< sine of how far a level upper arm may be from level: 30 degrees
constexpr float kUpright = 0.8F;  ///< cosine of how far an upright forearm may be from upright: 37 degrees
constexpr float kCrossed = 0.2F;  ///< how far crossed hands pass each other, shoulders' widths
constexpr float kBeside = 1.F;    ///< how far either hand may be beside the shoulders' middle, shoulders' widths
constexpr float kBelowTorso_m = 0.15F;

bool is_psi(const Joints& joints, const Eigen::Vector3f& up) {
  const auto one_side = [&](NiteJointType shoulder, NiteJointType elbow, NiteJointType hand, NiteJointType other) {
    const Eigen::Vector3f& from = joints[shoulder].position;
    const Eigen::Vector3f upper = (joints[elbow].position - from).normalized();
    const Eigen::Vector3f fore = (joints[hand].position - joints[elbow].position).normalized();
    return std::abs(upper.dot(up)) < kLevel && fore.dot(up) > kUpright &&
           upper.dot((from - joints[other].position).normalized()) > kLevel;
  };
  return one_side(NITE_JOINT_LEFT_SHOULDER, NITE_JOINT_LEFT_ELBOW, NITE_JOINT_LEFT_HAND, NITE_JOINT_RIGHT_SHOULDER) &&
         one_side(NITE_JOINT_RIGHT_SHOULDER, NITE_JOINT_RIGHT_ELBOW, NITE_JOINT_RIGHT_HAND, NITE_JOINT_LEFT_SHOULDER);
}

bool is_crossed(const Joints& joints, const Eigen::Vector3f& up) {
  const Eigen::Vector3f left = joints[NITE_JOINT_LEFT_SHOULDER].position;
  const Eigen::Vector3f right = joints[NITE_JOINT_RIGHT_SHOULDER].position;
  const float width = std::max((left - right).norm(), 1e-3F);
  const Eigen::Vector3f side = (left - right) / width, middle = (left + right) / 2.F;
  const float neck = up.dot(joints[NITE_JOINT_NECK].position), torso = up.dot(joints[NITE_JOINT_TORSO].position);
  const auto beside = [&](NiteJointType hand) { return side.dot(joints[hand].position - middle) / width; };
  const auto at_chest = [&](NiteJointType hand) {
    const float height = up.dot(joints[hand].position);
    return height < neck && height > torso - kBelowTorso_m && std::abs(beside(hand)) < kBeside;
  };
  return beside(NITE_JOINT_RIGHT_HAND) - beside(NITE_JOINT_LEFT_HAND) > kCrossed && at_chest(NITE_JOINT_LEFT_HAND) &&
         at_chest(NITE_JOINT_RIGHT_HAND);
}

}  // namespace

bool holds_pose(const Joints& joints, NitePoseType pose, const Eigen::Vector3f& up) {
  const auto is_known = [&](NiteJointType joint) {
    return joints[joint].state != State::none && joints[joint].confidence >= kLeastConfidence;
  };
  for (const NiteJointType joint : {NITE_JOINT_LEFT_SHOULDER, NITE_JOINT_RIGHT_SHOULDER, NITE_JOINT_LEFT_ELBOW,
                                    NITE_JOINT_RIGHT_ELBOW, NITE_JOINT_LEFT_HAND, NITE_JOINT_RIGHT_HAND}) {
    if (!is_known(joint)) return false;
  }
  if (pose == NITE_POSE_PSI) return is_psi(joints, up);
  return is_known(NITE_JOINT_NECK) && is_known(NITE_JOINT_TORSO) && is_crossed(joints, up);
}

}  // namespace vesalius::nite2
