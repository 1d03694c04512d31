#pragma once

#include <Eigen/Core>
#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/person.h"

namespace vesalius {

/// Returns the centres of the parts that were observed or predicted, NaN for the others.
std::vector<Eigen::Vector3f> given_centres(const Skeleton& skeleton);

/// Returns one joint. It needs seen or predicted parts with at least half of its weight; the weights of those count for
/// all, and the offsets stay. `up` is the body's axis (body_up).
Joint derive_joint(const JointDefinition& definition, const Skeleton& skeleton, const Eigen::Vector3f& up);

/// Returns the joints of all joint sets of the body model, [set][joint], from parts drawn to their votes.
std::vector<std::vector<Joint>> derive_joints(const BodyModel& body, const Skeleton& skeleton);

}  // namespace vesalius
