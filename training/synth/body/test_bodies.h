#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <utility>

#include "synth/body/body_mesh.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// Returns a pose in which every joint is turned by up to `most_rad` about any axis, with any heading.
inline Pose random_pose(Random& random, float most_rad) {
  Pose pose;
  for (Eigen::Quaternionf& q : pose.local) {
    Eigen::Vector3f axis(static_cast<float>(random.normal()), static_cast<float>(random.normal()),
                         static_cast<float>(random.normal()));
    axis = axis.norm() > 1e-3F ? Eigen::Vector3f(axis.normalized()) : Eigen::Vector3f::UnitX();
    q = Eigen::AngleAxisf(static_cast<float>(random.uniform()) * most_rad, axis);
  }
  const Eigen::AngleAxisf heading(static_cast<float>(random.uniform(-3.0, 3.0)), Eigen::Vector3f::UnitY());
  pose[Bone::pelvis] = heading * pose[Bone::pelvis];
  pose.l_grip = static_cast<float>(random.uniform());
  pose.r_grip = static_cast<float>(random.uniform());
  return pose;
}

/// Returns whether a point is inside a closed surface, by counting a ray's crossings with their direction.
inline bool is_inside(const std::vector<Eigen::Vector3f>& vertices, const std::vector<Triangle>& triangles,
                      std::size_t count, const Eigen::Vector3f& p) {
  // Any direction would do; this one meets no edge of a grid.
  const Eigen::Vector3d ray = Eigen::Vector3d(0.3141, 0.2718, 0.9093).normalized();
  int winding = 0;
  for (std::size_t t = 0; t < count; ++t) {
    const Eigen::Vector3d a = (vertices[triangles[t][0]] - p).cast<double>();
    const Eigen::Vector3d b = (vertices[triangles[t][1]] - p).cast<double>();
    const Eigen::Vector3d c = (vertices[triangles[t][2]] - p).cast<double>();
    const double u = ray.dot(b.cross(c));
    const double v = ray.dot(c.cross(a));
    const double w = ray.dot(a.cross(b));
    const bool out = u > 0 && v > 0 && w > 0;
    const bool in = u < 0 && v < 0 && w < 0;
    if (!out && !in) continue;
    if (a.dot((b - a).cross(c - a)) / (u + v + w) > 0) winding += out ? 1 : -1;
  }
  return winding > 0;
}

/// Returns the distance of a point from a triangle (Ericson, "Real-Time Collision Detection", 5.1.5).
inline float distance_to(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c,
                         const Eigen::Vector3f& p) {
  const Eigen::Vector3f ab = b - a, ac = c - a;
  const auto at = [&](float v, float w) { return (p - (a + v * ab + w * ac)).norm(); };
  const float d1 = ab.dot(p - a), d2 = ac.dot(p - a), d3 = ab.dot(p - b), d4 = ac.dot(p - b), d5 = ab.dot(p - c),
              d6 = ac.dot(p - c);
  if (d1 <= 0.F && d2 <= 0.F) return at(0.F, 0.F);
  if (d3 >= 0.F && d4 <= d3) return at(1.F, 0.F);
  if (d6 >= 0.F && d5 <= d6) return at(0.F, 1.F);
  const float va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  if (vc <= 0.F && d1 >= 0.F && d3 <= 0.F) return at(d1 / (d1 - d3), 0.F);
  if (vb <= 0.F && d2 >= 0.F && d6 <= 0.F) return at(0.F, d2 / (d2 - d6));
  if (va <= 0.F && d4 - d3 >= 0.F && d5 - d6 >= 0.F) {
    const float w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return at(1.F - w, w);
  }
  return at(vb / (va + vb + vc), vc / (va + vb + vc));
}

/// Returns the distance of a point from the nearest of the first `count` triangles.
inline float distance_to(const std::vector<Eigen::Vector3f>& vertices, const std::vector<Triangle>& triangles,
                         std::size_t count, const Eigen::Vector3f& p) {
  float nearest = std::numeric_limits<float>::max();
  for (std::size_t t = 0; t < count; ++t) {
    const Triangle& tri = triangles[t];
    nearest = std::min(nearest, distance_to(vertices[tri[0]], vertices[tri[1]], vertices[tri[2]], p));
  }
  return nearest;
}

/// Returns whether every edge is used as often in one direction as in the other.
inline bool is_closed(const std::vector<Triangle>& triangles, std::size_t count) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (std::size_t t = 0; t < count; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[t][k];
      const std::uint32_t b = triangles[t][(k + 1) % 3];
      edges[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
    }
  }
  return std::ranges::all_of(edges, [](const auto& e) { return e.second == 0; });
}

/// Returns a box from -1 to 1 m, moved by one rig bone for all bones of poses. The left half is `left_part`, the right
/// half `right_part`. The middle plane cuts no triangle.
inline BodyMesh box_body(std::uint8_t left_part, std::uint8_t right_part) {
  BodyMesh mesh;
  auto topology = std::make_shared<BodyTopology>();
  for (const float x : {-1.F, 0.F, 1.F}) {
    for (const auto& [y, z] : {std::pair{0.F, -1.F}, {2.F, -1.F}, {2.F, 1.F}, {0.F, 1.F}})
      mesh.vertices.emplace_back(x, y, z);
  }
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d, std::uint8_t part) {
    topology->triangles.push_back({a, b, c});
    topology->triangles.push_back({a, c, d});
    topology->part.insert(topology->part.end(), 2, part);
  };
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t next = (k + 1) % 4;
    quad(k, k + 4, next + 4, next, right_part);
    quad(k + 4, k + 8, next + 8, next + 4, left_part);
  }
  quad(0, 1, 2, 3, right_part);
  quad(8, 11, 10, 9, left_part);
  for (Triangle& t : topology->triangles) std::swap(t[1], t[2]);
  topology->fabric.assign(topology->triangles.size(), Fabric::skin);
  topology->skin.assign(mesh.vertices.size(), SkinWeights{{0, 0, 0, 0}, {1.F, 0.F, 0.F, 0.F}});
  topology->body_triangles = topology->triangles.size();
  mesh.topology = topology;
  RigBone bone;
  bone.name = "root";
  bone.head = {0.F, 1.F, 0.F};
  bone.tail = {0.F, 2.F, 0.F};
  mesh.rig = {bone};
  mesh.stature_m = 2.F;
  return mesh;
}

}  // namespace vesalius::synth
