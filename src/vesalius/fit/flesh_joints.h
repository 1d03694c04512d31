#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "vesalius/base/body_model.h"
#include "vesalius/derive_joints.h"
#include "vesalius/fit/fitted_body.h"
#include "vesalius/fit/flesh_model.h"

namespace vesalius {

/// A joint that another tracker names, as a point of a bone.
struct FleshJoint {
  std::string set, name;
  int bone = -1;
  float along = 0.F;                                   ///< 0 is the bone's head, 1 its tail
  Eigen::Vector3f offset_m = Eigen::Vector3f::Zero();  ///< from there, in the bone's frame
};

/// Parses joint sets. Throws Error naming `source`, line and expectation.
std::vector<FleshJoint> parse_flesh_joints(std::string_view toml, const std::string& source, const FleshModel& flesh);

/// Returns the joints of the built-in flesh (data/bodies/flesh_joints.toml).
const std::vector<FleshJoint>& builtin_flesh_joints();

/// Gives the joints of a body's sets the places that a fitted body has for them, [set][joint]. Joints without such a
/// place stay as they are.
void place_joints(const FittedBody& fitted, const std::vector<FleshJoint>& places, const BodyModel& body,
                  std::vector<std::vector<Joint>>& joints);

}  // namespace vesalius
