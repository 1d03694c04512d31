#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "vesalius/base/frame.h"
#include "vesalius/fit/joint_trust.h"

namespace vesalius {

/// A bone of a body that was fitted to a person, in the order of the flesh model's bones.
struct FittedBone {
  State state = State::none;                             ///< observed where the camera sees flesh about the head
  Eigen::Vector3f head = Eigen::Vector3f::Zero();        ///< joint about which it turns, metres, optical frame
  Eigen::Vector3f tail = Eigen::Vector3f::Zero();        ///< its other end
  Eigen::Quaternionf global{1.F, 0.F, 0.F, 0.F};         ///< optical frame from the bone's
  Eigen::Quaternionf local{1.F, 0.F, 0.F, 0.F};          ///< parent's frame from the bone's; of the root as `global`
  float length_m = 0.F;                                  ///< length from head to tail
  Eigen::Matrix3f covariance = Eigen::Matrix3f::Zero();  ///< covariance of the head in square metres
  int support = 0;                                       ///< points of the person on the bone
  float confidence = 0.F;         ///< probability that the head lies within 10 cm of the truth, 0-1
  float tail_confidence = 0.F;    ///< the same of the tail
  TrustSignals of_head, of_tail;  ///< what the confidences follow from
};

/// A body fitted to one person.
struct FittedBody {
  std::vector<FittedBone> bones;
  std::vector<float> shape;  ///< coefficients of the flesh model's shapes, in standard deviations of the population
  float stature_m = 0.F;     ///< height of the body standing upright
  float misfit = 0.F;        ///< mean cost of a point, lower is better
  bool hidden = false;       ///< moved on from an earlier frame, since the person was not found in this one
};

/// Returns how the place of a bone of a body is known.
inline JointSource source_of(const FittedBody& body, const FittedBone& bone) {
  if (body.hidden) return JointSource::hidden;
  return bone.state == State::observed ? JointSource::observed : JointSource::predicted;
}

}  // namespace vesalius
