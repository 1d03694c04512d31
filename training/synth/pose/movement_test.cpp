#include "synth/pose/movement.h"

#include <gtest/gtest.h>

#include "synth/pose/fidget.h"
#include "synth/pose/pose_sampler.h"
#include "synth/pose/self_contact.h"

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

}  // namespace
}  // namespace vesalius::synth
