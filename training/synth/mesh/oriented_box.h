#pragma once

#include <Eigen/Geometry>
#include <array>

namespace vesalius::synth {

/// A box that bodies and furniture must stay out of. Lengths are in metres.
struct OrientedBox {
  Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();  ///< parent_from_box; the centre of the box is its origin
  Eigen::Vector3f half = Eigen::Vector3f::Zero();          ///< half the size along its own axes

  float radius() const { return half.norm(); }
};

/// Returns the box after a motion, for example into another frame.
OrientedBox moved(const OrientedBox& box, const Eigen::Isometry3f& motion);

/// Returns the depth of a point below the box's surface; it is 0 or less outside.
float depth_inside(const OrientedBox& box, const Eigen::Vector3f& point);

/// Returns whether the boxes overlap by more than `slack_m` (separating axes).
bool overlap(const OrientedBox& a, const OrientedBox& b, float slack_m);

/// Returns whether the straight line from a to b meets the box.
bool blocks(const OrientedBox& box, const Eigen::Vector3f& a, const Eigen::Vector3f& b);

std::array<Eigen::Vector3f, 8> corners(const OrientedBox& box);

}  // namespace vesalius::synth
