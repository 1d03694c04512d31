#pragma once

#include <Eigen/Geometry>
#include <array>

namespace vesalius::synth {

/// A box that bodies and furniture must keep out of. Metres.
struct OrientedBox {
  Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();  ///< parent_from_box; the box's centre is its origin
  Eigen::Vector3f half = Eigen::Vector3f::Zero();          ///< half its size along its own axes

  float radius() const { return half.norm(); }
};

/// Returns the same box in the parent's parent.
OrientedBox moved(const OrientedBox& box, const Eigen::Isometry3f& motion);

/// Returns how far the point is below the box's surface; 0 or less outside.
float depth_inside(const OrientedBox& box, const Eigen::Vector3f& point);

/// Returns whether the boxes overlap by more than `slack_m` (separating axes).
bool overlap(const OrientedBox& a, const OrientedBox& b, float slack_m);

/// Returns whether the straight way from a to b meets the box.
bool blocks(const OrientedBox& box, const Eigen::Vector3f& a, const Eigen::Vector3f& b);

std::array<Eigen::Vector3f, 8> corners(const OrientedBox& box);

}  // namespace vesalius::synth
