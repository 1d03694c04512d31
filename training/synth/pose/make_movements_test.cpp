#include "synth/pose/make_movements.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "synth/pose/joint_angles.h"
#include "synth/pose/judge_pose.h"
#include "synth/pose/pose.h"
#include "synth/pose/pose_sampler.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

/// Draws a pose of one posture.
Pose draw(Posture posture, Random& random) {
  PoseSamplerOptions options;
  for (;;) {
    const SampledPose drawn = sample_pose(options, random);
    if (drawn.posture == posture) return drawn.pose;
  }
}

/// Returns the height of a bone's head over the lowest point, metres.
float height_of(Bone bone, const Pose& pose) {
  const StickFigure figure = stick_figure(pose);
  float lowest = figure.head[0].y();
  for (std::size_t b = 0; b < kBoneCount; ++b) lowest = std::min({lowest, figure.head[b].y(), figure.tail[b].y()});
  return figure.head_of(bone).y() - lowest;
}

TEST(MoveThrough, HasEachPoseAtItsTimeAndLeavesTheFeetWhereTheyAre) {
  Random random(2);
  const Pose a = draw(Posture::standing, random), b = draw(Posture::sitting, random), c = draw(Posture::lying, random);
  const Movement movement = move_through(std::array{KeyPose{a, 0.F}, KeyPose{b, 1.F}, KeyPose{c, 2.5F, true}});
  EXPECT_FLOAT_EQ(movement.seconds(), 2.5F);
  EXPECT_LT(largest_angle(movement.states.front().pose, a), 1e-3F);
  EXPECT_LT(largest_angle(state_at(movement, 1.F).pose, b), 1e-3F);
  EXPECT_LT(largest_angle(movement.states.back().pose, c), 1e-3F);
  EXPECT_LT(movement.states.front().root.norm(), 1e-6F);
  const float leg_m = bone_length_m(Bone::l_thigh) + bone_length_m(Bone::l_shin);
  const auto ankles = [&](const BodyState& state) -> Eigen::Vector2f {
    const StickFigure figure = stick_figure(state.pose);
    const Vector3f middle = 0.5F * (figure.head_of(Bone::l_foot) + figure.head_of(Bone::r_foot));
    return leg_m * state.root + Eigen::Vector2f(middle.x(), middle.z());
  };
  for (const BodyState& state : movement.states) {
    EXPECT_LT((ankles(state) - ankles(movement.states.front())).norm(), 1e-4F);
  }
}

TEST(MoveThrough, LeavesThePelvisWhereTheFeetDoNotStay) {
  Random random(4);
  const Pose a = draw(Posture::standing, random), b = draw(Posture::sitting, random),
             c = draw(Posture::sitting, random);
  const Movement movement = move_through(std::array{KeyPose{a, 0.F}, KeyPose{b, 1.F}, KeyPose{c, 2.F, false, false}});
  const Eigen::Vector2f there = root_at(movement, 1.F);
  EXPECT_GT(there.norm(), 0.05F);
  for (float time_s = 1.F; time_s < 2.F; time_s += 0.1F) EXPECT_LT((root_at(movement, time_s) - there).norm(), 1e-3F);
}

TEST(FallDown, EndsOnTheFloorWithinASecondOrSoAndGetsFaster) {
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
    Random random(seed);
    const Pose standing = draw(Posture::standing, random), lying = draw(Posture::lying, random);
    const Movement fall = fall_down(standing, lying, random);
    EXPECT_GE(fall.seconds(), 0.7F);
    EXPECT_LE(fall.seconds(), 1.25F);
    EXPECT_EQ(classify_posture(fall.states.back().pose), Posture::lying);
    const float whole = height_of(Bone::chest, standing) - height_of(Bone::chest, lying);
    const Pose soon = state_at(fall, 0.25F * fall.seconds()).pose;
    EXPECT_LT(height_of(Bone::chest, standing) - height_of(Bone::chest, soon), 0.25F * whole);
  }
}

TEST(SitDown, BendsTheTrunkForwardsOnTheWay) {
  Random random(3);
  const Pose standing = pose_of(BodyAngles{});
  BodyAngles seat;
  for (LegAngles& leg : seat.legs) leg = {.flexion = 90.F, .knee = 90.F};
  const Movement sitting = sit_down(standing, pose_of(seat), random);
  const auto lean = [](const Pose& pose) {
    const Vector3f up = world_rotations(pose)[index(Bone::chest)] * Vector3f::UnitY();
    return std::atan2(up.z(), up.y());
  };
  EXPECT_NEAR(lean(sitting.states.front().pose), 0.F, 1e-3F);
  EXPECT_GT(lean(state_at(sitting, 0.5F * sitting.seconds()).pose), 0.25F);
  EXPECT_NEAR(lean(sitting.states.back().pose), 0.F, 1e-3F);
  // The seat is behind the feet.
  EXPECT_LT(sitting.states.back().root.y(), -0.3F);
}

}  // namespace
}  // namespace vesalius::synth
