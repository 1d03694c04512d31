#include "synth/pose/mix_poses.h"

#include <gtest/gtest.h>

#include "synth/pose/posture.h"
#include "synth/pose/self_contact.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

std::vector<SampledPose> some_poses(int count) {
  Random random(4);
  std::vector<SampledPose> poses;
  for (int i = 0; i < count; ++i) poses.push_back(sample_pose({}, random));
  return poses;
}

bool same(const Pose& a, const Pose& b, Bone bone) { return a[bone].coeffs() == b[bone].coeffs(); }

/// Returns whether the pose is one of those, apart from its grips.
bool is_one_of(const Pose& pose, const std::vector<SampledPose>& poses) {
  return std::ranges::any_of(poses, [&](const SampledPose& p) { return largest_angle(p.pose, pose) < 1e-3F; });
}

TEST(MixLimbs, TakesOnlyTheGivenLimbs) {
  const std::vector<SampledPose> poses = some_poses(2);
  const Pose &a = poses[0].pose, &b = poses[1].pose;
  const Pose arm = mix_limbs(a, b, {.l_arm = true});
  EXPECT_TRUE(same(arm, b, Bone::l_clavicle) && same(arm, b, Bone::l_hand));
  EXPECT_EQ(arm.l_grip, b.l_grip);
  EXPECT_TRUE(same(arm, a, Bone::r_hand) && same(arm, a, Bone::l_shin) && same(arm, a, Bone::head));
  const Pose legs = mix_limbs(a, b, {.legs = true, .head = true});
  EXPECT_TRUE(same(legs, b, Bone::pelvis) && same(legs, b, Bone::r_foot) && same(legs, b, Bone::neck));
  EXPECT_TRUE(same(legs, a, Bone::chest) && same(legs, a, Bone::l_forearm));
  EXPECT_EQ(legs.l_grip, a.l_grip);
}

TEST(MixLimbs, PutsAllLimbsOnAnotherTrunk) {
  const std::vector<SampledPose> poses = some_poses(2);
  const Pose all = mix_limbs(poses[0].pose, poses[1].pose, {true, true, true, true});
  for (int b = 0; b < kBoneCount; ++b) {
    const auto bone = static_cast<Bone>(b);
    const bool trunk = bone == Bone::spine || bone == Bone::chest;
    EXPECT_TRUE(same(all, poses[trunk ? 0 : 1].pose, bone)) << bone_name(bone);
  }
}

TEST(DrawPose, DrawsPossiblePoses) {
  const std::vector<SampledPose> poses = some_poses(60);
  Random random(8);
  int known = 0;
  for (int i = 0; i < 300; ++i) {
    const SampledPose drawn = draw_pose(poses, 1.F, 0.5F, random);
    EXPECT_FALSE(intersects_itself(drawn.pose));
    EXPECT_EQ(classify_posture(drawn.pose), drawn.posture);
    known += is_one_of(drawn.pose, poses) || is_one_of(mirrored(drawn.pose), poses) ? 1 : 0;
  }
  EXPECT_LT(known, 60) << "most are mixtures";
}

TEST(DrawPose, MirrorsAndMixesWithTheGivenProbabilities) {
  const std::vector<SampledPose> poses = some_poses(60);
  Random random(8);
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(is_one_of(draw_pose(poses, 0.F, 0.F, random).pose, poses));
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(is_one_of(mirrored(draw_pose(poses, 0.F, 1.F, random).pose), poses));
}

TEST(DrawPose, IsTheSameForTheSameSeedAndRefusesAnEmptyList) {
  const std::vector<SampledPose> poses = some_poses(20);
  Random a(1), b(1);
  const SampledPose first = draw_pose(poses, 0.5F, 0.5F, a), again = draw_pose(poses, 0.5F, 0.5F, b);
  for (std::size_t j = 0; j < kBoneCount; ++j) EXPECT_EQ(first.pose.local[j].coeffs(), again.pose.local[j].coeffs());
  EXPECT_EQ(first.pose.l_grip, again.pose.l_grip);
  EXPECT_THROW(draw_pose({}, 0.5F, 0.5F, a), UsageError);
}

}  // namespace
}  // namespace vesalius::synth
