#include "synth/pose/stick_figure.h"

#include <gtest/gtest.h>

namespace vesalius::synth {
namespace {

constexpr float kPi = 3.14159265F;

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
