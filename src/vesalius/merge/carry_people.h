#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "vesalius/person.h"

namespace vesalius {

/// Gives joints the places that they have in another frame, `to_from` being its transformation. Metres.
void carry(std::vector<std::vector<Joint>>& joints, const Eigen::Isometry3f& to_from);
/// The same of a body: places, turns and covariances of its bones.
void carry(FittedBody& body, const Eigen::Isometry3f& to_from);
/// The same of all about somebody that has a place or a direction, `ahead_s` seconds later as the person moves. What
/// belongs to the picture (mask, labels, box, yaw, points) stays as it is.
void carry(TrackedPerson& person, const Eigen::Isometry3f& to_from, float ahead_s);
/// Returns how another camera stands over the same floor.
FloorView carried(const FloorView& floor, const Eigen::Isometry3f& to_from);

}  // namespace vesalius
