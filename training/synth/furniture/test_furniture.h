#pragma once

#include <gtest/gtest.h>

#include "synth/furniture/furniture.h"

// What the tests of all furniture share.
namespace vesalius::synth::test {

inline Eigen::AlignedBox3f bounds_of(const SceneMesh& mesh) {
  Eigen::AlignedBox3f bounds;
  for (const Eigen::Vector3f& p : mesh.vertices) bounds.extend(p);
  return bounds;
}

inline void expect_valid(const SceneMesh& mesh, std::size_t most_triangles) {
  ASSERT_EQ(mesh.material.size(), mesh.triangles.size());
  EXPECT_LT(mesh.triangles.size(), most_triangles);
  for (const Eigen::Vector3f& p : mesh.vertices) ASSERT_TRUE(p.allFinite());
  for (const Triangle& t : mesh.triangles) {
    for (const std::uint32_t corner : t) ASSERT_LT(corner, mesh.vertices.size());
  }
  for (const std::uint8_t material : mesh.material) ASSERT_LT(material, mesh.materials.size());
}

}  // namespace vesalius::synth::test
