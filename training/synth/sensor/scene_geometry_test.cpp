#include "synth/sensor/scene_geometry.h"

#include <gtest/gtest.h>

#include <set>

#include "vesalius/base/random.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

View wide_view() {
  View view;
  view.camera = {100, 100, 50.F, 50.F, 49.5F, 49.5F};
  return view;
}

/// Returns the corners of all triangles of the quads, with the lowest first.
std::multiset<Triangle> triangles_of(const SceneGeometry& geometry) {
  std::multiset<Triangle> result;
  for (const auto& q : geometry.quads) {
    for (Triangle t : {Triangle{q[0], q[1], q[3]}, Triangle{q[2], q[3], q[1]}}) {
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
      std::rotate(t.begin(), std::ranges::min_element(t), t.end());
      result.insert(t);
    }
  }
  return result;
}

TEST(SceneGeometry, HasExactlyTheTrianglesOfTheScene) {
  Random random(3);
  SceneMesh mesh;
  for (int i = 0; i < 60; ++i) {
    const auto within = [&] { return static_cast<float>(random.uniform(-1.0, 1.0)); };
    mesh.vertices.emplace_back(within(), within(), 3.F);
  }
  std::multiset<Triangle> expected;
  const auto corner = [&] { return random.below(60); };
  while (mesh.triangles.size() < 200) {
    const Triangle t = {corner(), corner(), corner()};
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    mesh.triangles.push_back(t);
    if (random.below(2) == 0) mesh.triangles.push_back({t[1], t[0], (t[0] + 7) % 60 == t[1] ? t[2] : (t[0] + 7) % 60});
  }
  for (Triangle t : mesh.triangles) {
    std::rotate(t.begin(), std::ranges::min_element(t), t.end());
    expected.insert(t);
  }
  Scene scene;
  scene.meshes = {mesh};
  SceneGeometry geometry;
  geometry.gather(scene, wide_view(), std::nullopt);
  EXPECT_EQ(triangles_of(geometry), expected);
  EXPECT_LT(geometry.quads.size(), mesh.triangles.size());
}

TEST(SceneGeometry, KeepsPartPersonAndMaterialOfTriangles) {
  SceneMesh mesh;
  mesh.vertices = {{0, 0, 2}, {1, 0, 2}, {1, 1, 2}, {0, 1, 2}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.part = {4, kBackground};
  mesh.material = {1, 0};
  mesh.materials = {Material{}, Material{}};
  mesh.person = 3;
  Scene scene;
  scene.meshes = {SceneMesh{}, mesh};
  SceneGeometry geometry;
  geometry.gather(scene, wide_view(), std::nullopt);
  ASSERT_EQ(geometry.quads.size(), 1U);
  const auto& [first, second] = geometry.faces[0];
  EXPECT_EQ(first.part, 4);
  EXPECT_EQ(first.person, 3);
  EXPECT_EQ(first.material, 2);  // after the materials of the other mesh
  EXPECT_EQ(second.part, kBackground);
  EXPECT_EQ(second.person, kBackground);
  EXPECT_EQ(second.material, 1);
}

TEST(SceneGeometry, LeavesOutOnlyTrianglesThatNoRayCanMeet) {
  const auto kept = [](const Vector3f& at, const std::optional<Vector3f>& projector) {
    SceneMesh mesh;
    mesh.vertices = {at, at + Vector3f(0.01F, 0.F, 0.F), at + Vector3f(0.F, 0.01F, 0.F)};
    mesh.triangles = {{0, 1, 2}};
    Scene scene;
    scene.meshes = {mesh};
    SceneGeometry geometry;
    geometry.gather(scene, wide_view(), projector);
    return geometry.quads.size() == 1;
  };
  EXPECT_TRUE(kept({0.F, 0.F, 1.F}, {}));
  EXPECT_TRUE(kept({0.98F, 0.F, 1.F}, {}));
  EXPECT_FALSE(kept({1.1F, 0.F, 1.F}, {}));
  EXPECT_FALSE(kept({0.F, -1.2F, 1.F}, {}));
  EXPECT_FALSE(kept({0.F, 0.F, -1.F}, {}));
  // The light of a projector 20 cm to the right passes through space that the camera does not see.
  EXPECT_TRUE(kept({1.1F, 0.F, 1.F}, Vector3f(0.2F, 0.F, 0.F)));
  EXPECT_FALSE(kept({-1.1F, 0.F, 1.F}, Vector3f(0.2F, 0.F, 0.F)));
}

}  // namespace
}  // namespace vesalius::synth
