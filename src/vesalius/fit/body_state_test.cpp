#include "vesalius/fit/body_state.h"

#include <gtest/gtest.h>

#include <numbers>

#include "vesalius/base/random.h"
#include "vesalius/fit/test_flesh.h"

namespace vesalius {
namespace {

using Eigen::Vector3d;

Vector3d random_direction(Random& random) {
  const double x = random.normal(0.0, 1.0), y = random.normal(0.0, 1.0), z = random.normal(0.0, 1.0);
  return Vector3d(x, y, z).normalized();
}

TEST(BodyState, RotationVectorsComeBack) {
  Random random(1);
  for (const double angle : {0.0, 1e-9, 1e-6, 1e-3, 0.5, 2.0, 3.1, std::numbers::pi - 1e-9}) {
    for (int i = 0; i < 10; ++i) {
      const Vector3d vector = angle * random_direction(random);
      const Eigen::Quaterniond rotation = exp_rotation(vector);
      EXPECT_NEAR(rotation.norm(), 1.0, 1e-12);
      EXPECT_LT((log_rotation(rotation) - vector).norm(), 1e-7) << angle;
      const Eigen::Quaterniond same(-rotation.w(), -rotation.x(), -rotation.y(), -rotation.z());
      EXPECT_LT((log_rotation(same) - vector).norm(), 1e-7) << angle << " negated";
    }
  }
  EXPECT_TRUE((exp_rotation({0.0, 0.0, std::numbers::pi / 2.0}) * Vector3d::UnitX()).isApprox(Vector3d::UnitY(), 1e-9));
}

TEST(BodyState, DerivativeOfTheLogarithmIsThatOfSmallTurns) {
  constexpr double kStep = 1e-6;
  Random random(2);
  for (const double angle : {0.0, 5e-5, 1e-3, 0.3, 1.5, 3.0}) {
    const Vector3d vector = angle * random_direction(random);
    const Eigen::Matrix3d derivative = log_by_turn(vector);
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = [&](double by) {
        return log_rotation(exp_rotation(vector) * exp_rotation(by * Vector3d::Unit(axis)));
      };
      const Vector3d numeric = (at(kStep) - at(-kStep)) / (2.0 * kStep);
      EXPECT_LT((derivative.col(axis) - numeric).norm(), 1e-5) << angle;
    }
  }
}

TEST(BodyState, BonesHangOnTheirParents) {
  const FleshModel& flesh = builtin_flesh();
  BodyState state = test::usual_state(0.0);
  for (Eigen::Quaterniond& local : state.local) local.setIdentity();
  state.local[0] = test::upright(0.0);
  const std::vector<PlacedBone> placed = place_bones(flesh, state);
  EXPECT_EQ(placed[0].head, state.root);
  // In the T, before the camera: the head is up (-y), the person's left is on the right of the picture.
  EXPECT_LT(placed[flesh.find_bone("head")].tail.y(), state.root.y() - 0.5);
  EXPECT_GT(placed[flesh.find_bone("l_hand")].head.x(), state.root.x() + 0.5);
  EXPECT_LT(placed[flesh.find_bone("r_hand")].head.x(), state.root.x() - 0.5);
  EXPECT_LT(placed[flesh.find_bone("l_foot")].tail.z(), placed[flesh.find_bone("l_foot")].head.z())
      << "toes point here";
  // An elbow bent about y by a right angle takes the hand to the front.
  BodyState bent = state;
  test::turn(bent, "l_forearm", {0.0, -std::numbers::pi / 2.0, 0.0});
  const std::vector<PlacedBone> after = place_bones(flesh, bent);
  const int forearm = flesh.find_bone("l_forearm"), hand = flesh.find_bone("l_hand");
  EXPECT_TRUE(after[forearm].head.isApprox(placed[forearm].head, 1e-9));
  EXPECT_NEAR((after[hand].head - after[forearm].head).norm(), (placed[hand].head - placed[forearm].head).norm(), 1e-9);
  EXPECT_LT(after[hand].head.z(), placed[hand].head.z() - 0.15);
}

TEST(BodyState, HeadsMoveWithTheShapeAsTheirDerivativeSays) {
  constexpr double kStep = 1e-4;
  const FleshModel& flesh = builtin_flesh();
  const StateLayout layout(flesh);
  const BodyState state = test::random_state(3, 0.4);
  const std::vector<PlacedBone> placed = place_bones(flesh, state);
  for (int k = 0; k < flesh.shapes; ++k) {
    Eigen::VectorXd step = Eigen::VectorXd::Zero(layout.size());
    step[layout.shape() + k] = kStep;
    const std::vector<PlacedBone> more = place_bones(flesh, moved(state, step));
    const std::vector<PlacedBone> less = place_bones(flesh, moved(state, -step));
    for (int b = 0; b < flesh.bone_count(); ++b) {
      const Vector3d numeric = (more[b].head - less[b].head) / (2.0 * kStep);
      EXPECT_LT((placed[b].head_by_shape.col(k) - numeric).norm(), 1e-8) << flesh.bones[b].name;
    }
  }
}

}  // namespace
}  // namespace vesalius
