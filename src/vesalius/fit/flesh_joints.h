#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "vesalius/body_model.h"
#include "vesalius/fit/flesh_model.h"
#include "vesalius/fit/joint_trust.h"
#include "vesalius/person.h"

namespace vesalius {

/// A joint that another tracker names, as a point of a bone.
struct FleshJoint {
  std::string set, name;
  int bone = -1;
  float along = 0.F;                                   ///< 0 is the bone's head, 1 its tail
  Eigen::Vector3f offset_m = Eigen::Vector3f::Zero();  ///< offset from there, in the bone's frame
  std::optional<Eigen::Quaternionf> axes;              ///< bone's frame from the joint's, if the tracker turns joints
  bool x_on_bone = false;                              ///< whether the joint's x axis follows the bone's line exactly
};

/// Parses joint sets. Throws Error naming `source`, line and expectation.
std::vector<FleshJoint> parse_flesh_joints(std::string_view toml, const std::string& source, const FleshModel& flesh);

/// Returns the joints of the built-in flesh (data/bodies/flesh_joints.toml).
const std::vector<FleshJoint>& builtin_flesh_joints();

/// Returns the place of that joint, or null if there is none.
const FleshJoint* find_flesh_joint(const std::vector<FleshJoint>& places, std::string_view set, std::string_view name);

/// Returns what the confidence of a joint follows from.
TrustSignals signals_of(const FleshJoint& joint, const FittedBody& fitted);

/// Gives the joints of a body's sets the places that a fitted body has for them, [set][joint]. Joints without such a
/// place stay as they are.
void place_joints(const FittedBody& fitted, const std::vector<FleshJoint>& places, const BodyModel& body,
                  const BodyTrust& trust, std::vector<std::vector<Joint>>& joints);

/// Returns for each joint of a set the rotation that the tracker which names it would give: optical frame from the
/// joint's. Nothing for joints without axes, and where nothing is known of the bone.
std::vector<std::optional<Eigen::Quaternionf>> joint_rotations(const FittedBody& fitted,
                                                               const std::vector<FleshJoint>& places,
                                                               const JointSet& set);

/// Returns the same by the person's body; without one nothing for every joint.
std::vector<std::optional<Eigen::Quaternionf>> rotations_of(const TrackedPerson& person, const JointSet& set);

}  // namespace vesalius
