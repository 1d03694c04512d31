#include "synth/pose/movement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "synth/pose/judge_pose.h"
#include "synth/pose/make_movements.h"
#include "synth/pose/pose.h"
#include "synth/pose/pose_sampler.h"

namespace vesalius::synth {
namespace {

Movement two_states() {
  Movement movement;
  movement.fps = 10.F;
  movement.states.resize(2);
  movement.states[1].pose[Bone::l_forearm] = Eigen::AngleAxisf(1.F, Eigen::Vector3f::UnitX());
  movement.states[1].heading_rad = 0.5F;
  movement.states[1].root = {0.2F, 0.4F};
  return movement;
}

TEST(Movement, GoesEvenlyFromStateToState) {
  const Movement movement = two_states();
  EXPECT_FLOAT_EQ(movement.seconds(), 0.1F);
  const BodyState half = state_at(movement, 0.05F);
  EXPECT_NEAR(half.pose[Bone::l_forearm].angularDistance(Eigen::Quaternionf::Identity()), 0.5F, 1e-4F);
  EXPECT_NEAR(half.heading_rad, 0.25F, 1e-6F);
  EXPECT_TRUE(half.root.isApprox(Eigen::Vector2f(0.1F, 0.2F), 1e-5F));
  EXPECT_EQ(root_at(movement, 0.05F), half.root);
  EXPECT_EQ(heading_at(movement, 0.05F), half.heading_rad);
  EXPECT_EQ(state_at(movement, -3.F).root, movement.states[0].root);
  EXPECT_EQ(state_at(movement, 3.F).root, movement.states[1].root);
}

TEST(Movement, HasAMirrorImage) {
  const Movement mirror = mirrored(two_states());
  EXPECT_EQ(mirror.states[1].heading_rad, -0.5F);
  EXPECT_EQ(mirror.states[1].root, Eigen::Vector2f(-0.2F, 0.4F));
  EXPECT_NEAR(mirror.states[1].pose[Bone::r_forearm].angularDistance(Eigen::Quaternionf::Identity()), 1.F, 1e-4F);
}

TEST(Fidget, MovesArmsAndHeadOnlyAndWithinHumanSpeed) {
  Random random(5);
  std::vector<Pose> others;
  for (int i = 0; i < 4; ++i) others.push_back(sample_pose({}, random).pose);
  const Pose base = sample_pose({}, random).pose;
  const Movement movement = fidget(base, others, 6.F, random);
  EXPECT_GE(movement.seconds(), 6.F);
  float moved_rad = 0.F;
  for (std::size_t i = 0; i < movement.states.size(); ++i) {
    const Pose& pose = movement.states[i].pose;
    for (const Bone bone : {Bone::pelvis, Bone::spine, Bone::l_thigh, Bone::r_shin, Bone::l_foot}) {
      EXPECT_LT(pose[bone].angularDistance(base[bone]), 1e-3F);
    }
    moved_rad = std::max(moved_rad, largest_angle(pose, base));
    if (i == 0) continue;
    EXPECT_LT(largest_angle(pose, movement.states[i - 1].pose) * movement.fps, 3.F);
  }
  EXPECT_GT(moved_rad, 0.2F);
  const Movement still = fidget(base, {}, 1.F, random);
  EXPECT_LT(largest_angle(still.states.back().pose, base), 1e-3F);
}

/// Returns a recording of a gait that is walked straight into a direction.
Movement recording_of(const Gait& gait, float heading_rad, float seconds) {
  Movement movement;
  movement.fps = 30.F;
  const Eigen::Rotation2Df turn(-heading_rad);  // x and z: a heading turns z to x
  for (int i = 0; i < static_cast<int>(seconds * movement.fps); ++i) {
    BodyState state = state_at(gait, static_cast<float>(i) / movement.fps);
    state.root = turn * state.root;
    state.heading_rad += heading_rad;
    movement.states.push_back(state);
  }
  return movement;
}

TEST(Gait, GoesOnFromPeriodToPeriod) {
  Random random(3);
  const Gait gait = sample_gait(random);
  const BodyState late = state_at(gait, 2.F * gait.period_s + 0.3F), early = state_at(gait, 0.3F);
  EXPECT_NEAR(late.root.y() - early.root.y(), 2.F * gait.stride, 1e-4F);
  EXPECT_LT(largest_angle(late.pose, early.pose), 0.01F);
  float before = -1.F;
  for (float t = -0.5F; t < 3.F; t += 0.01F) {
    const Eigen::Vector2f root = root_at(gait, t);
    EXPECT_EQ(root, state_at(gait, t).root);
    EXPECT_GE(root.y(), before - 1e-5F) << "nobody walks backwards";
    before = root.y();
  }
}

TEST(Gait, KeepsTheStandingFootInPlace) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    Random random(seed);
    const Gait gait = sample_gait(random);
    EXPECT_GT(gait.speed(), 0.15F);
    EXPECT_LT(gait.speed(), 2.5F);
    const float leg_m = bone_length_m(Bone::l_thigh) + bone_length_m(Bone::l_shin);
    float slipped_m = 0.F;
    for (int i = 0; i < 100; ++i) {
      const auto feet = [&](int k) {
        const BodyState state = state_at(gait, 0.01F * gait.period_s * static_cast<float>(k));
        std::array<Eigen::Vector3f, 4> points{};
        const StickFigure figure = stick_figure(state.pose);
        std::size_t n = 0;
        for (const Bone foot : {Bone::l_foot, Bone::r_foot}) {
          for (const Eigen::Vector3f& p : {figure.head_of(foot), figure.tail_of(foot)}) {
            points[n++] = p + Eigen::Vector3f(0.F, 0.F, leg_m * state.root.y());
          }
        }
        return points;
      };
      const auto a = feet(i), b = feet(i + 1);
      float least_m = 1.F;
      for (std::size_t p = 0; p < a.size(); ++p) least_m = std::min(least_m, std::abs(b[p].z() - a[p].z()));
      slipped_m += least_m;
    }
    EXPECT_LT(slipped_m, 0.15F * leg_m * gait.stride) << "seed " << seed;
  }
}

TEST(Gait, IsFoundInARecordingOfIt) {
  Random random(8);
  const Gait gait = sample_gait(random);
  const std::optional<Gait> found = find_gait(recording_of(gait, 0.7F, 4.F));
  ASSERT_TRUE(found);
  EXPECT_NEAR(std::remainder(found->period_s, gait.period_s), 0.F, 0.05F);
  EXPECT_NEAR(found->speed(), gait.speed(), 0.03F * gait.speed());
  for (const BodyState& state : found->states) {
    EXPECT_LT(std::abs(state.heading_rad), 0.1F);
    EXPECT_LT(std::abs(state.root.x()), 0.05F);
  }
  const Gait mirror = mirrored(*found);
  EXPECT_EQ(mirror.stride, found->stride);
  EXPECT_NEAR(state_at(mirror, 0.2F).root.x(), -state_at(*found, 0.2F).root.x(), 1e-6F);
}

TEST(Gait, IsNotFoundWhereNobodyWalks) {
  Random random(8);
  const Gait gait = sample_gait(random);
  Movement still = recording_of(gait, 0.F, 4.F);
  for (BodyState& state : still.states) state.root.setZero();
  EXPECT_FALSE(find_gait(still));
  Movement backwards = recording_of(gait, 0.F, 4.F);
  for (BodyState& state : backwards.states) state.root *= -1.F;
  EXPECT_FALSE(find_gait(backwards));
  Movement once = recording_of(gait, 0.F, 0.5F);
  EXPECT_FALSE(find_gait(once)) << "shorter than a period";
}

}  // namespace

}  // namespace vesalius::synth
