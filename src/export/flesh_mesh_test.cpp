#include "export/flesh_mesh.h"

#include <gtest/gtest.h>

#include <map>
#include <utility>

#include "vesalius/fit/test_flesh.h"

namespace vesalius {
namespace {

std::vector<int> all_bones() {
  std::vector<int> bones;
  for (int b = 0; b < builtin_flesh().bone_count(); ++b) bones.push_back(b);
  return bones;
}

TEST(FleshMesh, IsClosedAndTurnsOutwards) {
  const FleshMesh mesh = flesh_mesh(builtin_flesh(), all_bones(), test::random_state(5, 0.1).shape);
  std::map<std::pair<int, int>, int> edges;
  std::vector<double> volumes(builtin_flesh().bones.size());
  std::size_t against = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
    const auto corner = [&](std::size_t i) { return mesh.triangles[t + i % 3]; };
    for (std::size_t i = 0; i < 3; ++i) {
      ++edges[{corner(i), corner(i + 1)}];
      EXPECT_EQ(mesh.bones[corner(i)], mesh.bones[corner(0)]);
    }
    const Eigen::Vector3f &a = mesh.points[corner(0)], &b = mesh.points[corner(1)], &c = mesh.points[corner(2)];
    volumes[mesh.bones[corner(0)]] += double(a.dot(b.cross(c))) / 6.0;
    against += (b - a).cross(c - a).dot(mesh.normals[corner(0)]) < 0.F ? 1 : 0;
  }
  for (const auto& [edge, times] : edges) {
    EXPECT_EQ(times, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1U);
  }
  EXPECT_LT(300 * against, mesh.triangles.size()) << "a normal is the mean of what may be a sharp edge";
  double litres = 0.0;
  for (std::size_t b = 0; b < volumes.size(); ++b) {
    EXPECT_GT(volumes[b], 1e-5) << builtin_flesh().bones[b].name;
    litres += 1000.0 * volumes[b];
  }
  EXPECT_GT(litres, 40.0) << "a person's, with what overlaps";
  EXPECT_LT(litres, 120.0);
}

TEST(FleshMesh, ChangesWithTheShape) {
  const Eigen::VectorXd from = Eigen::VectorXd::Zero(builtin_flesh().shapes), to = test::random_state(6, 0.1).shape;
  const FleshMesh before = flesh_mesh(builtin_flesh(), all_bones(), from);
  const FleshMesh after = flesh_mesh(builtin_flesh(), all_bones(), to);
  for (std::size_t i = 0; i < before.points.size(); ++i) {
    Eigen::Vector3f at = before.points[i];
    for (std::size_t k = 0; k < before.shapes.size(); ++k) {
      at += static_cast<float>(to[static_cast<Eigen::Index>(k)]) * before.shapes[k][i];
    }
    EXPECT_LT((at - after.points[i]).norm(), 0.012F) << "rounded ends may reach out by the other half width";
  }
}

}  // namespace
}  // namespace vesalius
