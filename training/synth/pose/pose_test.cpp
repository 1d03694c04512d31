#include "synth/pose/pose.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "vesalius/base/random.h"

namespace vesalius::synth {
namespace {

constexpr float kPi = 3.14159265F;

Eigen::Quaternionf turn(float angle_rad, const Eigen::Vector3f& axis) {
  return Eigen::Quaternionf(Eigen::AngleAxisf(angle_rad, axis));
}

Eigen::Quaternionf any_rotation(Random& random) {
  const auto n = [&] { return static_cast<float>(random.normal()); };
  return Eigen::Quaternionf(n(), n(), n(), n()).normalized();
}

Pose any_pose(std::uint64_t seed) {
  Random random(seed);
  Pose pose;
  for (Eigen::Quaternionf& q : pose.local) q = any_rotation(random);
  pose.l_grip = static_cast<float>(random.uniform());
  pose.r_grip = static_cast<float>(random.uniform());
  return pose;
}

TEST(Bone, HasAUniqueNameByWhichItIsFound) {
  std::set<std::string> names;
  for (int b = 0; b < kBoneCount; ++b) {
    const auto bone = static_cast<Bone>(b);
    EXPECT_EQ(find_bone(bone_name(bone)), b);
    names.insert(std::string(bone_name(bone)));
  }
  EXPECT_EQ(names.size(), static_cast<std::size_t>(kBoneCount));
  EXPECT_EQ(find_bone("tail"), -1);
  EXPECT_EQ(bone_name(Bone::r_shin), "r_shin");
}

TEST(Bone, ComesAfterItsParentAndMirrorsWithIt) {
  EXPECT_EQ(parent(Bone::pelvis), Bone::pelvis);
  for (int b = 1; b < kBoneCount; ++b) {
    const auto bone = static_cast<Bone>(b);
    EXPECT_LT(index(parent(bone)), b);
    EXPECT_EQ(mirror(mirror(bone)), bone);
    EXPECT_EQ(mirror(parent(bone)), parent(mirror(bone)));
    EXPECT_TRUE(rest_direction(mirror(bone)).isApprox(rest_direction(bone).cwiseProduct(Eigen::Vector3f(-1, 1, 1))));
  }
  EXPECT_EQ(mirror(Bone::l_hand), Bone::r_hand);
  EXPECT_EQ(mirror(Bone::chest), Bone::chest);
  EXPECT_EQ(parent(Bone::l_thigh), Bone::pelvis);
}

TEST(Pose, HasWorldRotationsThatAreProductsFromThePelvis) {
  Pose pose;
  pose[Bone::pelvis] = turn(kPi / 2, Eigen::Vector3f::UnitY());    // the person faces their left
  pose[Bone::l_thigh] = turn(-kPi / 2, Eigen::Vector3f::UnitX());  // the knee is lifted to the front
  pose[Bone::l_shin] = turn(kPi / 2, Eigen::Vector3f::UnitX());
  const auto world = world_rotations(pose);
  const auto direction = [&](Bone bone) { return (world[index(bone)] * rest_direction(bone)).eval(); };
  EXPECT_TRUE(direction(Bone::l_thigh).isApprox(Eigen::Vector3f::UnitX(), 1e-5F)) << direction(Bone::l_thigh);
  EXPECT_TRUE(direction(Bone::l_shin).isApprox(-Eigen::Vector3f::UnitY(), 1e-5F));
  EXPECT_TRUE(direction(Bone::l_foot).isApprox(Eigen::Vector3f::UnitX(), 1e-5F));
  EXPECT_TRUE(direction(Bone::l_upper_arm).isApprox(-Eigen::Vector3f::UnitZ(), 1e-5F));
}

TEST(Pose, IsRecoveredFromItsWorldRotations) {
  const Pose pose = any_pose(1);
  const Pose again = from_world_rotations(world_rotations(pose));
  EXPECT_LT(largest_angle(pose, again), 1e-3F);
  for (int b = 0; b < kBoneCount; ++b) EXPECT_NEAR(again.local[b].norm(), 1.F, 1e-5F);
}

TEST(Pose, HasReflectedWorldRotationsInAMirror) {
  const Pose pose = any_pose(2);
  const auto world = world_rotations(pose);
  const auto seen = world_rotations(mirrored(pose));
  const Eigen::Matrix3f s = Eigen::Vector3f(-1, 1, 1).asDiagonal();
  for (int b = 0; b < kBoneCount; ++b) {
    const Eigen::Matrix3f expected = s * world[index(mirror(static_cast<Bone>(b)))].toRotationMatrix() * s;
    EXPECT_TRUE(seen[b].toRotationMatrix().isApprox(expected, 1e-4F)) << bone_name(static_cast<Bone>(b));
  }
}

TEST(Pose, IsTheSameWhenMirroredTwice) {
  const Pose pose = any_pose(3);
  const Pose again = mirrored(mirrored(pose));
  for (int b = 0; b < kBoneCount; ++b) EXPECT_EQ(again.local[b].coeffs(), pose.local[b].coeffs());
  EXPECT_EQ(again.l_grip, pose.l_grip);
  EXPECT_EQ(mirrored(pose).l_grip, pose.r_grip);
}

TEST(Pose, DiffersByTheLargestAngleOfOneJoint) {
  const Pose a = any_pose(4);
  Pose b = a;
  EXPECT_NEAR(largest_angle(a, b), 0.F, 1e-3F);
  b[Bone::l_shin] = b[Bone::l_shin] * turn(0.2F, Eigen::Vector3f::UnitX());
  b[Bone::head] = b[Bone::head] * turn(-0.5F, Eigen::Vector3f::UnitZ());
  EXPECT_NEAR(largest_angle(a, b), 0.5F, 1e-4F);
  b[Bone::head].coeffs() *= -1.F;  // the same rotation
  EXPECT_NEAR(largest_angle(a, b), 0.5F, 1e-4F);
}

TEST(Pose, DoesNotDifferByItsHeading) {
  const Pose a = any_pose(5);
  Pose b = a;
  b[Bone::pelvis] = turn(2.F, Eigen::Vector3f::UnitY()) * a[Bone::pelvis];
  EXPECT_NEAR(largest_angle(a, b), 0.F, 2e-3F);
  b[Bone::pelvis] = a[Bone::pelvis] * turn(0.3F, a[Bone::pelvis].conjugate() * Eigen::Vector3f::UnitX());
  EXPECT_GT(largest_angle(a, b), 0.05F);
  const Eigen::Quaternionf upside_down = turn(kPi, Eigen::Vector3f::UnitX());
  EXPECT_TRUE(without_yaw(upside_down).coeffs().allFinite());
}

TEST(Posture, HasNames) {
  EXPECT_EQ(to_string(Posture::standing), "standing");
  EXPECT_EQ(to_string(Posture::kneeling), "kneeling");
}

TEST(StickFigure, HasTheProportionsOfAnAdult) {
  const StickFigure figure = stick_figure(Pose());
  const float ankle_m = 0.039F * kStickStature_m;  // Drillis and Contini: the rest of the height is below the ankle
  const float floor_y = figure.tail_of(Bone::l_shin).y() - ankle_m;
  EXPECT_NEAR(figure.tail_of(Bone::head).y() - floor_y, kStickStature_m, 0.01F);
  EXPECT_NEAR(figure.head_of(Bone::l_upper_arm).y() - floor_y, 0.818F * kStickStature_m, 0.02F);
  EXPECT_NEAR(figure.head_of(Bone::l_thigh).y() - floor_y, 0.53F * kStickStature_m, 0.01F);
  EXPECT_NEAR(figure.tail_of(Bone::l_hand).x() - figure.tail_of(Bone::r_hand).x(), kStickStature_m, 0.2F)
      << "arm span; segments overlap where they were measured";
  EXPECT_GT(figure.tail_of(Bone::l_hand).x(), 0.F);
  EXPECT_GT(figure.tail_of(Bone::r_foot).z(), 0.F);
}

TEST(StickFigure, HasConnectedBonesOfConstantLength) {
  Pose pose;
  for (int b = 0; b < kBoneCount; ++b) {
    pose.local[b] =
        Eigen::AngleAxisf(0.1F * static_cast<float>(b), Eigen::Vector3f(1.F, static_cast<float>(b), 2.F).normalized());
  }
  const StickFigure figure = stick_figure(pose);
  for (const Bone bone : {Bone::l_forearm, Bone::r_hand, Bone::l_shin, Bone::r_foot, Bone::head}) {
    EXPECT_TRUE(figure.head_of(bone).isApprox(figure.tail_of(parent(bone)), 0.2F)) << bone_name(bone);
    EXPECT_NEAR((figure.tail_of(bone) - figure.head_of(bone)).norm(), bone_length_m(bone), 1e-5F);
  }
}

TEST(StickFigure, TurnsWithTheJoints) {
  Pose pose;
  pose[Bone::l_thigh] = Eigen::AngleAxisf(-kPi / 2, Eigen::Vector3f::UnitX());
  const StickFigure figure = stick_figure(pose);
  const Eigen::Vector3f knee = figure.tail_of(Bone::l_thigh) - figure.head_of(Bone::l_thigh);
  EXPECT_TRUE(knee.isApprox(Eigen::Vector3f(0, 0, bone_length_m(Bone::l_thigh)), 1e-5F)) << "to the front";
}

}  // namespace

}  // namespace vesalius::synth
