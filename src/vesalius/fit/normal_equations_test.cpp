#include "vesalius/fit/normal_equations.h"

#include <gtest/gtest.h>

#include "vesalius/base/random.h"
#include "vesalius/fit/test_flesh.h"

namespace vesalius {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

Vector3d random_vector(Random& random) {
  const double x = random.normal(0.0, 1.0), y = random.normal(0.0, 1.0), z = random.normal(0.0, 1.0);
  return {x, y, z};
}

VectorXd random_numbers(Random& random, Eigen::Index count) {
  VectorXd numbers(count);
  for (double& number : numbers) number = random.normal(0.0, 1.0);
  return numbers;
}

/// The same sums without any structure.
struct Dense {
  explicit Dense(int size) : matrix(MatrixXd::Zero(size, size)), gradient(VectorXd::Zero(size)) {}
  void add(const VectorXd& row, double residual, double weight) {
    matrix += weight * row * row.transpose();
    gradient += weight * residual * row;
    cost += weight * residual * residual;
  }
  MatrixXd matrix;
  VectorXd gradient;
  double cost = 0.0;
};

TEST(NormalEquations, PointsMoveWithTheStateAsTheirDerivativeSays) {
  constexpr double kStep = 1e-6;
  const FleshModel& flesh = builtin_flesh();
  const StateLayout layout(flesh);
  const BodyState state = test::random_state(4, 0.4);
  const std::vector<PlacedBone> placed = place_bones(flesh, state);
  const NormalEquations equations(flesh);
  const Vector3d in_bone(0.05, -0.1, 0.07);
  for (int b = 0; b < flesh.bone_count(); ++b) {
    const Vector3d at = placed[b].head + placed[b].global * in_bone;
    const Eigen::Matrix3Xd derivative = equations.point_by_state(b, at, placed);
    ASSERT_EQ(derivative.cols(), layout.size());
    for (int i = 0; i < layout.size(); ++i) {
      const auto moved_by = [&](double by) {
        const std::vector<PlacedBone> after = place_bones(flesh, moved(state, by * VectorXd::Unit(layout.size(), i)));
        return Vector3d(after[b].head + after[b].global * in_bone);
      };
      const Vector3d numeric = (moved_by(kStep) - moved_by(-kStep)) / (2.0 * kStep);
      EXPECT_LT((derivative.col(i) - numeric).norm(), 1e-7) << flesh.bones[b].name << ", unknown " << i;
    }
  }
}

TEST(NormalEquations, EqualTheDenseSums) {
  const FleshModel& flesh = builtin_flesh();
  const StateLayout layout(flesh);
  const std::vector<PlacedBone> placed = place_bones(flesh, test::random_state(5, 0.4));
  NormalEquations equations(flesh);
  Random random(6);
  for (int round = 0; round < 2; ++round) {  // the second starts from nothing again
    Dense dense(layout.size());
    equations.clear(placed);
    for (int b = 0; b < flesh.bone_count(); ++b) {
      const int points = b == 3 ? 200 : b == 5 ? 0 : 3;  // more than a block holds at first, none, few
      for (int i = 0; i < points; ++i) {
        const Vector3d at = placed[b].head + 0.1 * random_vector(random), direction = random_vector(random);
        const VectorXd by_shape = random_numbers(random, flesh.shapes);
        const double residual = random.normal(0.0, 1.0), weight = 0.1 + random.uniform();
        equations.add_point(b, at, direction, by_shape, residual, weight);
        VectorXd row = equations.point_by_state(b, at, placed).transpose() * direction;
        row.tail(flesh.shapes) += by_shape;
        dense.add(row, residual, weight);
      }
    }
    const std::vector<int> bones{7, 2, 8};
    const MatrixXd derivative = random_numbers(random, 36).reshaped(4, 9);
    const VectorXd residuals = random_numbers(random, 4);
    equations.add_turns(bones, derivative, residuals, 0.7);
    for (int r = 0; r < 4; ++r) {
      VectorXd row = VectorXd::Zero(layout.size());
      for (int i = 0; i < 3; ++i) {
        row.segment<3>(StateLayout::turn(bones[i])) = derivative.row(r).segment<3>(3 * i).transpose();
      }
      dense.add(row, residuals[r], 0.7);
    }
    equations.add_single(1, 2.0, -0.5, 3.0);
    dense.add(2.0 * VectorXd::Unit(layout.size(), 1), -0.5, 3.0);
    const MatrixXd root = random_numbers(random, flesh.shapes * flesh.shapes).reshaped(flesh.shapes, flesh.shapes);
    const VectorXd off = random_numbers(random, flesh.shapes);
    equations.add_shape(root.transpose() * root, off);
    for (int r = 0; r < flesh.shapes; ++r) {
      VectorXd row = VectorXd::Zero(layout.size());
      row.tail(flesh.shapes) = root.row(r).transpose();
      dense.add(row, root.row(r).dot(off), 1.0);
    }
    equations.add_cost(2.5);
    equations.finish();
    EXPECT_TRUE(equations.matrix().isApprox(dense.matrix, 1e-9));
    EXPECT_TRUE(equations.gradient().isApprox(dense.gradient, 1e-9));
    EXPECT_NEAR(equations.cost(), dense.cost + 2.5, 1e-6);
  }
}

}  // namespace
}  // namespace vesalius
