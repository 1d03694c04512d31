#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "metrics/fit_samples.h"
#include "vesalius/body_model.h"
#include "vesalius/derive_joints.h"

namespace vesalius {

/// What was given out for a person, and where a joint of that person truly is.
struct JointSample {
  Skeleton skeleton;
  Eigen::Vector3f truth = Eigen::Vector3f::Zero();  ///< metres, optical frame
};

/// Fewest samples to which a joint is fitted.
inline constexpr std::size_t kLeastJointSamples = 100;

/// Returns the joint with parts, weights and offsets fitted to the samples: of its own parts and those linked to them
/// at most three. Weights may be negative: a wrist lies beyond its forearm as seen from the elbow, however the arm is
/// held and however long it is.
/// Errors cost as Huber's loss does, up to a limit, since a part on the wrong limb says nothing about a joint's place;
/// a joint that is not derived any more costs that limit. Samples count whose observed parts give the joint as it is. A
/// joint that is its own mirror image stays so: its parts of both sides share a weight. Parts and an offset along the
/// body that hardly lower the loss are left out. Weights are rounded to hundredths, offsets to millimetres. Returns the
/// joint as it is if it has no parts or fewer than kLeastJointSamples count. Without `with_neighbours` only its own
/// parts are used.
JointDefinition fit_joint(const JointDefinition& joint, const std::vector<JointSample>& samples, const BodyModel& body,
                          bool with_neighbours = true);

/// Returns the body's joint sets of which the people's truth has joints, fitted to them; a joint that it lacks stays as
/// it is. A set with a joint under each part's name is fitted to the parts' centres,
/// each from its own part. Joints of both sides are fitted
/// together where their definitions are mirror images.
std::vector<JointSet> fit_joint_sets(const std::vector<KnownPerson>& people, const BodyModel& body);

/// Returns the joint with every part replaced by its partner on the other side.
JointDefinition mirrored(JointDefinition joint, const BodyModel& body);
/// Returns the skeleton with the places of each part and its partner exchanged: `mirrored` joints derived from it lie
/// where the joints of `skeleton` do.
Skeleton mirrored(const Skeleton& skeleton, const BodyModel& body);

}  // namespace vesalius
