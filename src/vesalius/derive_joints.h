#pragma once

#include <Eigen/Core>
#include <vector>

#include "vesalius/base/body_model.h"
#include "vesalius/base/frame.h"
#include "vesalius/search_skeletons.h"

namespace vesalius {

/// A joint of one of the body model's joint sets.
struct Joint {
  State state = State::none;
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< metres, optical frame; NaN where state is none
  float confidence = 0.F;                              ///< 0-1
};

/// Returns the centres of the parts that were observed or predicted, NaN for the others.
std::vector<Eigen::Vector3f> given_centres(const Skeleton& skeleton);

/// Returns one joint. It needs seen or predicted parts with at least half of its weight; the weights of those count for
/// all, and the offsets stay. `up` is the body's axis (body_up).
Joint derive_joint(const JointDefinition& definition, const Skeleton& skeleton, const Eigen::Vector3f& up);

/// Returns the joints of all joint sets of the body model, [set][joint].
std::vector<std::vector<Joint>> derive_joints(const BodyModel& body, const Skeleton& skeleton);

}  // namespace vesalius
