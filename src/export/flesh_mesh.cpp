#include "export/flesh_mesh.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>

namespace vesalius {
namespace {

constexpr int kAround = 14;  // points of a ring
/// Sines of the rings of a rounded end, from its pole, which is a point, on.
constexpr std::array<float, 3> kRoundings{0.92F, 0.7F, 0.38F};
constexpr int kRings = 2 * static_cast<int>(kRoundings.size()) + FleshBone::kStations;
constexpr int kPoints = kRings * kAround + 2;  // of a bone

/// What of a bone's surface is the same for all shapes. Its points are linear in the bone's numbers then.
struct Ends {
  float along = 1.F;              ///< 1 where the tail lies towards the bone's axis, -1 where against it
  std::array<int, 2> narrower{};  ///< of head and tail: which half width the end reaches out by
};

Ends ends_of(const FleshBone& bone, const FleshBone::Numbers& numbers) {
  Ends ends;
  ends.along = numbers[3 + bone.axis] < 0.F ? -1.F : 1.F;
  for (int end = 0; end < 2; ++end) {
    const auto half = ellipse_of(bone, numbers, end * (FleshBone::kStations - 1)).half;
    ends.narrower[end] = std::abs(half[1]) < std::abs(half[0]) ? 1 : 0;
  }
  return ends;
}

/// Returns a bone's points in its frame: the head's pole, the rings from head to tail, the tail's pole.
std::vector<Eigen::Vector3f> points_of(const FleshBone& bone, const FleshBone::Numbers& numbers, const Ends& ends) {
  std::vector<Eigen::Vector3f> points;
  const auto ring = [&](int station, float sine, int count) {
    const FleshEllipse<float> ellipse = ellipse_of(bone, numbers, station);
    const float cosine = std::sqrt(1.F - sine * sine);
    Eigen::Vector3f centre = ellipse.centre;
    centre[bone.axis] += sine * ends.along * ellipse.half[ends.narrower[station == 0 ? 0 : 1]];
    for (int i = 0; i < count; ++i) {
      const float angle = 2.F * std::numbers::pi_v<float> * static_cast<float>(i) / kAround;
      Eigen::Vector3f& point = points.emplace_back(centre);
      point[ellipse.across[0]] += std::cos(angle) * cosine * ellipse.half[0];
      point[ellipse.across[1]] += std::sin(angle) * cosine * ellipse.half[1];
    }
  };
  constexpr int kLast = FleshBone::kStations - 1;
  ring(0, -1.F, 1);
  for (const float sine : kRoundings) ring(0, -sine, kAround);
  for (int station = 0; station <= kLast; ++station) ring(station, 0.F, kAround);
  for (auto sine = kRoundings.rbegin(); sine != kRoundings.rend(); ++sine) ring(kLast, *sine, kAround);
  ring(kLast, 1.F, 1);
  return points;
}

/// Adds the triangles of a bone whose points begin at `first`. `turns` says whether its rings go round
/// counter-clockwise as seen from its tail.
void add_triangles(int first, bool turns, std::vector<std::uint16_t>& triangles) {
  const auto add = [&](int a, int b, int c) {
    for (const int point : {a, turns ? b : c, turns ? c : b}) {
      triangles.push_back(static_cast<std::uint16_t>(first + point));
    }
  };
  const auto at = [](int ring, int i) { return 1 + ring * kAround + i % kAround; };
  for (int i = 0; i < kAround; ++i) {
    add(0, at(0, i + 1), at(0, i));
    for (int ring = 0; ring + 1 < kRings; ++ring) {
      add(at(ring, i), at(ring, i + 1), at(ring + 1, i));
      add(at(ring, i + 1), at(ring + 1, i + 1), at(ring + 1, i));
    }
    add(at(kRings - 1, i), at(kRings - 1, i + 1), kPoints - 1);
  }
}

/// Returns the means of the triangles about each point, by their area.
std::vector<Eigen::Vector3f> normals_of(const FleshMesh& mesh) {
  std::vector<Eigen::Vector3f> normals(mesh.points.size(), Eigen::Vector3f::Zero());
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 3) {
    const Eigen::Vector3f& a = mesh.points[mesh.triangles[t]];
    const Eigen::Vector3f across =
        (mesh.points[mesh.triangles[t + 1]] - a).cross(mesh.points[mesh.triangles[t + 2]] - a);
    for (std::size_t i = 0; i < 3; ++i) normals[mesh.triangles[t + i]] += across;
  }
  for (Eigen::Vector3f& normal : normals) normal.normalize();
  return normals;
}

}  // namespace

FleshMesh flesh_mesh(const FleshModel& flesh, const std::vector<int>& bones, const Eigen::VectorXd& shape) {
  FleshMesh mesh;
  mesh.shapes.resize(static_cast<std::size_t>(flesh.shapes));
  for (std::size_t b = 0; b < bones.size(); ++b) {
    const FleshBone& bone = flesh.bones[bones[b]];
    const FleshBone::Numbers numbers = numbers_of(bone, shape);
    const Ends ends = ends_of(bone, numbers);
    // The axes across are in rising order: those across y are x and z, which turn the other way about it.
    const bool turns = (bone.axis == 1) == (ends.along < 0.F);
    add_triangles(static_cast<int>(mesh.points.size()), turns, mesh.triangles);
    const std::vector<Eigen::Vector3f> points = points_of(bone, numbers, ends);
    mesh.points.insert(mesh.points.end(), points.begin(), points.end());
    mesh.bones.insert(mesh.bones.end(), points.size(), static_cast<std::uint8_t>(b));
    for (std::size_t k = 0; k < mesh.shapes.size(); ++k) {
      const std::vector<Eigen::Vector3f> more = points_of(bone, bone.shapes[k], ends);
      mesh.shapes[k].insert(mesh.shapes[k].end(), more.begin(), more.end());
    }
  }
  mesh.normals = normals_of(mesh);
  return mesh;
}

}  // namespace vesalius
