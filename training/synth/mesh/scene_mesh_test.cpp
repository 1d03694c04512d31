#include "synth/mesh/scene_mesh.h"

#include <gtest/gtest.h>

#include <map>
#include <numbers>

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

/// Returns the volume by the divergence theorem. It is positive if triangles are counter-clockwise when seen from
/// outside.
double volume(const SceneMesh& mesh) {
  double sum = 0.0;
  for (const Triangle& t : mesh.triangles) {
    sum += mesh.vertices[t[0]].cast<double>().dot(
               mesh.vertices[t[1]].cast<double>().cross(mesh.vertices[t[2]].cast<double>())) /
           6.0;
  }
  return sum;
}

TEST(Shapes, IncludeClosedBoxesThatFaceOutwards) {
  SceneMesh mesh;
  add_box(mesh, Vector3f(1.F, 2.F, 3.F), Vector3f(2.F, 4.F, 6.F), 0);
  EXPECT_NEAR(volume(mesh), 6.0, 1e-5);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) ++edges[{t[i], t[(i + 1) % 3]}];
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ((edges.count({edge.second, edge.first})), 1U);
  }
}

TEST(Shapes, GiveConesAndEllipsoidsTheirVolume) {
  SceneMesh cylinder;
  add_cone(cylinder, {0.F, 0.F, 0.F}, {0.F, 2.F, 0.F}, 0.5F, 0.5F, 0, 64);
  EXPECT_NEAR(std::abs(volume(cylinder)), std::numbers::pi * 0.25 * 2.0, 0.01);
  SceneMesh cone;
  add_cone(cone, {1.F, 0.F, 0.F}, {1.F, 0.F, 3.F}, 1.F, 0.F, 0, 64);
  EXPECT_NEAR(std::abs(volume(cone)), std::numbers::pi, 0.02);
  SceneMesh ellipsoid;
  Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
  pose.translation().x() = 5.F;
  add_ellipsoid(ellipsoid, pose, {1.F, 2.F, 0.5F}, 0, 40);
  EXPECT_NEAR(std::abs(volume(ellipsoid)), 4.0 / 3.0 * std::numbers::pi, 0.03);
}

TEST(Shapes, HangCurtainsBetweenTheirCorners) {
  SceneMesh mesh;
  add_curtain(mesh, {0.F, 2.F, 1.F}, {1.5F, 2.F, 1.F}, 1.8F, 0.06F, 5, 0);
  Eigen::AlignedBox3f bounds;
  for (const Vector3f& p : mesh.vertices) bounds.extend(p);
  EXPECT_NEAR(bounds.min().y(), 0.2F, 1e-5F);
  EXPECT_NEAR(bounds.sizes().x(), 1.5F, 1e-5F);
  EXPECT_NEAR(bounds.sizes().z(), 0.06F, 0.01F);
}

TEST(Shapes, GiveEveryTriangleItsMaterial) {
  SceneMesh mesh;
  const std::uint8_t first = add_material(mesh, {}), second = add_material(mesh, {});
  add_box(mesh, Vector3f::Zero(), Vector3f::Ones(), first);
  add_quad(mesh, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, second);
  ASSERT_EQ(mesh.material.size(), mesh.triangles.size());
  EXPECT_EQ(mesh.material.front(), first);
  EXPECT_EQ(mesh.material.back(), second);
}

}  // namespace
}  // namespace vesalius::synth
