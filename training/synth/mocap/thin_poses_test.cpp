#include "synth/mocap/thin_poses.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "synth/pose/pose_sampler.h"
#include "vesalius/error.h"

namespace vesalius::synth {
namespace {

constexpr float kFiveDegrees = 5.F * 3.14159265F / 180.F;

/// Returns sampled poses, each followed by slow changes of itself like the frames of a motion.
std::vector<Pose> motion_like_poses(int count) {
  Random random(11);
  std::vector<Pose> poses;
  while (static_cast<int>(poses.size()) < count) {
    Pose pose = sample_pose({}, random).pose;
    for (int i = 0; i < 25; ++i) {
      for (Eigen::Quaternionf& q : pose.local) {
        const Eigen::Vector3d step(random.normal(), random.normal(), random.normal());
        const Eigen::Vector3f small = 0.012F * step.cast<float>();
        q = (q * Eigen::Quaternionf(1.F, small.x(), small.y(), small.z())).normalized();
      }
      poses.push_back(pose);
    }
  }
  poses.resize(count);
  return poses;
}

/// Returns whether largest_angle(a, b) >= min_angle_rad, and stops at the first joint that decides it.
bool far_apart(const Pose& a, const Pose& b, float min_angle_rad) {
  for (std::size_t j = 1; j < kBoneCount; ++j) {
    if (a.local[j].angularDistance(b.local[j]) >= min_angle_rad) return true;
  }
  return largest_angle(a, b) >= min_angle_rad;
}

std::vector<int> one_by_one(const std::vector<Pose>& poses, float min_angle_rad) {
  std::vector<int> kept;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    bool far = true;
    for (const int k : kept) far = far && far_apart(poses[i], poses[k], min_angle_rad);
    if (far) kept.push_back(static_cast<int>(i));
  }
  return kept;
}

TEST(ThinPoses, AgreesWithComparingAllPairs) {
  const std::vector<Pose> poses = motion_like_poses(5000);
  const std::vector<int> kept = thin_poses(poses, kFiveDegrees);
  EXPECT_GT(kept.size(), 500U);
  EXPECT_LT(kept.size(), 4500U);
  EXPECT_EQ(kept, one_by_one(poses, kFiveDegrees));
}

TEST(ThinPoses, AgreesForOtherAngles) {
  const std::vector<Pose> poses = motion_like_poses(600);
  for (const float angle : {0.01F, 0.5F, 1.5F, 3.F}) {
    EXPECT_EQ(thin_poses(poses, angle), one_by_one(poses, angle)) << angle;
  }
  EXPECT_THAT(thin_poses(poses, 4.F), testing::ElementsAre(0)) << "no angle is above 180 degrees";
  EXPECT_EQ(thin_poses(poses, 0.F).size(), poses.size());
}

TEST(ThinPoses, SeesASingleJointAndIgnoresTheSignsOfQuaternions) {
  std::vector<Pose> poses(3);
  poses[1][Bone::r_hand] = Eigen::Quaternionf(Eigen::AngleAxisf(1.01F * kFiveDegrees, Eigen::Vector3f::UnitZ()));
  poses[2][Bone::r_hand] = Eigen::Quaternionf(Eigen::AngleAxisf(0.5F * kFiveDegrees, Eigen::Vector3f::UnitZ()));
  for (Eigen::Quaternionf& q : poses[2].local) q.coeffs() *= -1.F;
  EXPECT_THAT(thin_poses(poses, kFiveDegrees), testing::ElementsAre(0, 1));
}

TEST(ThinPoses, HandlesManyEqualPosesAndNone) {
  EXPECT_TRUE(thin_poses({}, kFiveDegrees).empty());
  EXPECT_THAT(thin_poses(std::vector<Pose>(1000), kFiveDegrees), testing::ElementsAre(0));
}

TEST(ThinPoses, RefusesNumbersThatAreNotFinite) {
  std::vector<Pose> poses(2);
  EXPECT_THROW(thin_poses(poses, -1.F), Error);
  EXPECT_THROW(thin_poses(poses, std::numeric_limits<float>::quiet_NaN()), Error);
  poses[1][Bone::head].x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(thin_poses(poses, kFiveDegrees), Error);
}

}  // namespace
}  // namespace vesalius::synth
