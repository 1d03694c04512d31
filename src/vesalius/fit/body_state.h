#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "vesalius/fit/flesh_model.h"

namespace vesalius {

/// A pose and a shape of a flesh model in the optical frame.
struct BodyState {
  Eigen::Vector3d root = Eigen::Vector3d::Zero();  ///< head of the root bone, metres
  /// parent_from_bone of each bone; of the root optical_from_bone.
  std::vector<Eigen::Quaterniond> local;
  Eigen::VectorXd shape;
};

/// Numbers of a body state that a small change of it changes: the root's place, a turn of each bone about its own axes,
/// the shape.
struct StateLayout {
  explicit StateLayout(const FleshModel& flesh) : bones(flesh.bone_count()), shapes(flesh.shapes) {}
  int bones;
  int shapes;

  static int root() { return 0; }
  static int turn(int bone) { return 3 + 3 * bone; }
  int shape() const { return 3 + 3 * bones; }
  int size() const { return 3 + 3 * bones + shapes; }
};

/// Returns the state changed by `step` (StateLayout): turns are rotation vectors in the bones' own frames.
BodyState moved(const BodyState& state, const Eigen::VectorXd& step);

/// Where the bones of a state are.
struct PlacedBone {
  Eigen::Matrix3d global;      ///< optical frame from the bone's
  Eigen::Vector3d head, tail;  ///< metres, optical frame
  std::array<double, FleshBone::kNumbers> numbers;
  Eigen::Matrix3Xd head_by_shape;  ///< derivative of the head by the shape
};
std::vector<PlacedBone> place_bones(const FleshModel& flesh, const BodyState& state);

/// Returns the rotation vector of a rotation, of an angle up to pi.
Eigen::Vector3d log_rotation(const Eigen::Quaterniond& rotation);
Eigen::Quaterniond exp_rotation(const Eigen::Vector3d& vector);
/// Returns the derivative of log(exp(vector) exp(turn)) by `turn` at 0: the inverse of the right Jacobian of SO(3).
Eigen::Matrix3d log_by_turn(const Eigen::Vector3d& vector);

}  // namespace vesalius
