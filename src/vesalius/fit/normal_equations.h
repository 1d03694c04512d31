#pragma once

#include <Eigen/Core>
#include <vector>

#include "vesalius/fit/body_state.h"

namespace vesalius {

/// Sums of weighted squares of residuals and their derivatives by a state (StateLayout). Rows that move with the same
/// bone have the same few unknowns, and are multiplied together.
class NormalEquations {
 public:
  explicit NormalEquations(const FleshModel& flesh);

  void clear(const std::vector<PlacedBone>& placed);
  /// Adds a residual that grows by direction . x as the point `at` of a bone moves by x, and by `by_shape` with the
  /// shape besides (a point's own move with the shape included, the bone's head left out). `weight` multiplies its
  /// square.
  void add_point(int bone, const Eigen::Vector3d& at, const Eigen::Vector3d& direction,
                 const Eigen::Ref<const Eigen::VectorXd>& by_shape, double residual, double weight);
  /// Adds residuals of some turns: `derivative` is by the turns of `bones`, three columns each.
  void add_turns(const std::vector<int>& bones, const Eigen::MatrixXd& derivative, const Eigen::VectorXd& residuals,
                 double weight);
  /// Adds a residual of one unknown.
  void add_single(int unknown, double derivative, double residual, double weight);
  /// Adds off^T information off for the shape's deviation `off`.
  void add_shape(const Eigen::MatrixXd& information, const Eigen::VectorXd& off);
  /// Adds a cost that does not depend on the state.
  void add_cost(double cost) { cost_ += cost; }

  /// Completes the sums.
  void finish();
  double cost() const { return cost_; }
  const Eigen::MatrixXd& matrix() const { return matrix_; }      ///< half of the Hessian, complete
  const Eigen::VectorXd& gradient() const { return gradient_; }  ///< half of it

  /// Returns the derivative by the state of a point that moves with a bone, its own shape left out.
  Eigen::Matrix3Xd point_by_state(int bone, const Eigen::Vector3d& at, const std::vector<PlacedBone>& placed) const;

 private:
  struct Block {
    std::vector<int> chain;     ///< the bone and those above it, to the root
    Eigen::MatrixXd rows;       ///< unknowns of one row are a column
    Eigen::VectorXd residuals;  ///< times the root of the weight
    Eigen::Index count = 0;
  };

  StateLayout layout_;
  const std::vector<PlacedBone>* placed_ = nullptr;
  std::vector<Block> blocks_;
  Eigen::MatrixXd matrix_;
  Eigen::VectorXd gradient_;
  double cost_ = 0.0;
};

}  // namespace vesalius
