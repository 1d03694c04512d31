#include "synth/skeleton_joints.h"

#include <gmock/gmock.h>

#include <set>

#include "synth/body/builtin_body.h"
#include "synth/body/test_bodies.h"

namespace vesalius::synth {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;

const BodyMesh& mesh() {
  static const BodyMesh body = make_builtin_body({}, paper_body());
  return body;
}

PosedBody posed(const Pose& pose) { return Poser(std::make_shared<const BodyMesh>(mesh()), paper_body()).pose(pose); }

std::size_t joint(const std::string& name) {
  const auto& names = joint_names();
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

TEST(SkeletonJoints, HaveTheNamesOfBonesAndFreeEnds) {
  const auto& names = joint_names();
  ASSERT_EQ(names.size(), 24U);
  EXPECT_EQ(std::set<std::string>(names.begin(), names.end()).size(), names.size());
  for (std::size_t b = 0; b < kBoneCount; ++b) EXPECT_EQ(names[b], bone_name(static_cast<Bone>(b)));
  const PosedBody body = posed({});
  const std::vector<Vector3f> points = joint_points(body, Isometry3f::Identity());
  ASSERT_EQ(points.size(), names.size());
  EXPECT_EQ(points[joint("l_shin")], body.joints[index(Bone::l_shin)]);
  EXPECT_EQ(points[joint("r_hand_end")], body.ends[index(Bone::r_hand)]);
  EXPECT_GT(points[joint("head_end")].y(), points[joint("head")].y() + 0.1F);
}

TEST(SkeletonJoints, AreInTheCamerasFrame) {
  const PosedBody body = posed({});
  const Isometry3f motion = Eigen::Translation3f(0.5F, -1.F, 3.F) * Eigen::AngleAxisf(0.7F, Vector3f::UnitY());
  const std::vector<Vector3f> own = joint_points(body, Isometry3f::Identity());
  const std::vector<Vector3f> seen = joint_points(body, motion);
  for (std::size_t j = 0; j < own.size(); ++j) EXPECT_LT((seen[j] - motion * own[j]).norm(), 1e-6F) << joint_names()[j];
}

TEST(SkeletonJoints, LieInsideTheBody) {
  Random random(3);
  for (const float most_rad : {0.F, 0.4F, 0.4F}) {
    const PosedBody body = posed(random_pose(random, most_rad));
    const auto& triangles = mesh().topology->triangles;
    const std::vector<Vector3f> points = joint_points(body, Isometry3f::Identity());
    for (std::size_t j = 0; j < points.size(); ++j) {
      // Free ends lie on the surface, or off it by the rounding of fingers and toes. Those of closed hands lie where
      // the open hand would end.
      const bool inside = is_inside(body.vertices, triangles, mesh().topology->body_triangles, points[j]);
      const float off =
          inside ? 0.F : distance_to(body.vertices, triangles, mesh().topology->body_triangles, points[j]);
      EXPECT_LT(off, joint_names()[j].ends_with("hand_end") ? 0.07F : 0.02F)
          << joint_names()[j] << " at turns of " << most_rad;
    }
  }
}

TEST(SkeletonJoints, SwapSidesInAMirror) {
  Random random(4);
  const Pose pose = random_pose(random, 0.6F);
  const std::vector<Vector3f> own = joint_points(posed(pose), Isometry3f::Identity());
  const std::vector<Vector3f> other = joint_points(posed(mirrored(pose)), Isometry3f::Identity());
  for (std::size_t j = 0; j < own.size(); ++j) {
    std::string name = joint_names()[j];
    if (name.starts_with("l_") || name.starts_with("r_")) name[0] = name[0] == 'l' ? 'r' : 'l';
    const Vector3f expected(-own[j].x(), own[j].y(), own[j].z());
    EXPECT_LT((other[joint(name)] - expected).norm(), 1e-3F) << name;
  }
}

}  // namespace
}  // namespace vesalius::synth
