#include "synth/body/body_detail.h"

#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "synth/body/makehuman.h"
#include "synth/body/test_bodies.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

const Poser& person() {
  static const Poser poser(std::make_shared<const BodyMesh>(make_body(builtin_bodies(), {}, paper_body())),
                           paper_body());
  return poser;
}

const BodyDetail& detail() {
  static const BodyDetail levels(person());
  return levels;
}

TEST(BodyDetail, UsesCoarserSurfacesForLargerErrors) {
  EXPECT_EQ(detail().within(0.F), nullptr);
  EXPECT_EQ(detail().within(0.0004F), nullptr);
  std::size_t before = person().mesh().topology->triangles.size();
  for (const float error_m : {0.0005F, 0.001F, 0.0015F, 0.002F, 1.F}) {
    const CoarseSurface* coarse = detail().within(error_m);
    ASSERT_NE(coarse, nullptr);
    EXPECT_LE(coarse->error_m, error_m);
    EXPECT_LT(coarse->triangles.size(), before);
    before = coarse->triangles.size();
  }
  EXPECT_LT(before, person().mesh().topology->triangles.size() * 3 / 5);  // the built-in body is coarse already
}

TEST(BodyDetail, KeepsEveryPartAndAClosedSurface) {
  const CoarseSurface& coarsest = *detail().within(1.F);
  EXPECT_TRUE(is_closed(coarsest.triangles, coarsest.triangles.size()));
  for (int part = 0; part < paper_body().part_count(); ++part) {
    EXPECT_THAT(coarsest.part, testing::Contains(part)) << paper_body().parts[part].name;
  }
}

// Labels: statistics
TEST(BodyDetail, FollowsTheFullSurfaceInAnyPose) {
  const CoarseSurface& coarse = *detail().within(0.002F);
  Random random(5);
  for (const float most_rad : {0.F, 0.8F}) {
    const PosedBody body = person().pose(random_pose(random, most_rad));
    std::vector<Vector3f> kept;
    for (const std::uint32_t v : coarse.vertex) kept.push_back(body.vertices[v]);
    double squares = 0.0, count = 0.0, furthest = 0.0;
    for (std::size_t v = 0; v < body.vertices.size(); v += 11) {
      const auto off =
          static_cast<double>(distance_to(kept, coarse.triangles, coarse.triangles.size(), body.vertices[v]));
      squares += off * off;
      furthest = std::max(furthest, off);
      count += 1.0;
    }
    EXPECT_LT(std::sqrt(squares / count), 0.002) << most_rad;
    EXPECT_LT(furthest, 0.012) << most_rad;
  }
}

using Eigen::Vector3f;

/// A surface without a skeleton.
struct Surface {
  BodyTopology topology;
  std::vector<Vector3f> points;

  void add(const Triangle& t, std::uint8_t part) {
    topology.triangles.push_back(t);
    topology.part.push_back(part);
    topology.fabric.push_back(Fabric::skin);
  }
};

constexpr float kCell_m = 0.01F;

/// Returns a sheet of squares of 1 cm, `cells` in each direction. Columns beyond `border` have part 1. `height` returns
/// metres.
Surface sheet(std::uint32_t cells, std::uint32_t border, const std::function<float(float, float)>& height) {
  Surface s;
  for (std::uint32_t y = 0; y <= cells; ++y) {
    for (std::uint32_t x = 0; x <= cells; ++x) {
      const float px = kCell_m * static_cast<float>(x), py = kCell_m * static_cast<float>(y);
      s.points.emplace_back(px, py, height(px, py));
    }
  }
  const std::uint32_t row = cells + 1;
  for (std::uint32_t y = 0; y < cells; ++y) {
    for (std::uint32_t x = 0; x < cells; ++x) {
      const std::uint32_t a = y * row + x;
      const std::uint8_t part = x < border ? 0 : 1;
      s.add({a, a + 1, a + row + 1}, part);
      s.add({a, a + row + 1, a + row}, part);
    }
  }
  return s;
}

/// Returns a sphere of radius 10 cm as rings of quads, closed by fans.
Surface sphere(std::uint32_t rings, std::uint32_t sectors) {
  Surface s;
  const auto ring = [&](std::uint32_t i, std::uint32_t k) { return 1 + (i - 1) * sectors + k % sectors; };
  s.points.emplace_back(0.F, 0.1F, 0.F);
  for (std::uint32_t i = 1; i < rings; ++i) {
    for (std::uint32_t k = 0; k < sectors; ++k) {
      const float down = 3.14159265F * static_cast<float>(i) / static_cast<float>(rings);
      const float round = 6.2831853F * static_cast<float>(k) / static_cast<float>(sectors);
      s.points.push_back(0.1F *
                         Vector3f(std::sin(down) * std::cos(round), std::cos(down), std::sin(down) * std::sin(round)));
    }
  }
  s.points.emplace_back(0.F, -0.1F, 0.F);
  const auto last = static_cast<std::uint32_t>(s.points.size() - 1);
  for (std::uint32_t k = 0; k < sectors; ++k) {
    s.add({0, ring(1, k + 1), ring(1, k)}, 0);
    s.add({last, ring(rings - 1, k), ring(rings - 1, k + 1)}, 0);
    for (std::uint32_t i = 1; i + 1 < rings; ++i) {
      s.add({ring(i, k), ring(i, k + 1), ring(i + 1, k + 1)}, 0);
      s.add({ring(i, k), ring(i + 1, k + 1), ring(i + 1, k)}, 0);
    }
  }
  return s;
}

std::vector<Vector3f> points_of(const CoarseSurface& coarse, const std::vector<Vector3f>& points) {
  std::vector<Vector3f> kept;
  for (const std::uint32_t v : coarse.vertex) kept.push_back(points[v]);
  return kept;
}

std::map<int, float> areas(const std::vector<Vector3f>& points, const std::vector<Triangle>& triangles,
                           const std::vector<std::uint8_t>& part) {
  std::map<int, float> area;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Vector3f& a = points[triangles[t][0]];
    area[part[t]] += 0.5F * (points[triangles[t][1]] - a).cross(points[triangles[t][2]] - a).norm();
  }
  return area;
}

TEST(Simplify, ReducesAFlatSheetButKeepsTheBorderOfParts) {
  const Surface s = sheet(20, 8, [](float, float) { return 0.F; });
  const CoarseSurface coarse = simplify(s.topology, s.points, {0.0005F})[0];
  EXPECT_LT(coarse.triangles.size(), s.topology.triangles.size() / 8);
  const auto before = areas(s.points, s.topology.triangles, s.topology.part);
  const auto after = areas(points_of(coarse, s.points), coarse.triangles, coarse.part);
  ASSERT_EQ(after.size(), 2U);
  for (const auto& [part, area] : before) EXPECT_NEAR(after.at(part), area, 1e-6F) << part;
  for (std::size_t t = 0; t < coarse.triangles.size(); ++t) {  // no triangle lies across the border
    for (const std::uint32_t v : coarse.triangles[t]) {
      const float x = s.points[coarse.vertex[v]].x();
      EXPECT_TRUE(coarse.part[t] == 0 ? x <= 8 * kCell_m + 1e-6F : x >= 8 * kCell_m - 1e-6F);
    }
  }
}

// Labels: statistics
TEST(Simplify, KeepsASphereClosedAndWithinTheBound) {
  const Surface s = sphere(40, 80);
  ASSERT_TRUE(is_closed(s.topology.triangles, s.topology.triangles.size()));
  const std::vector<float> errors = {0.0002F, 0.0005F, 0.001F, 0.002F};
  const std::vector<CoarseSurface> levels = simplify(s.topology, s.points, errors);
  std::size_t before = s.topology.triangles.size();
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const CoarseSurface& level = levels[i];
    EXPECT_EQ(level.error_m, errors[i]);
    EXPECT_LT(level.triangles.size(), before * 3 / 4);
    before = level.triangles.size();
    EXPECT_TRUE(is_closed(level.triangles, level.triangles.size()));
    const std::vector<Vector3f> kept = points_of(level, s.points);
    double squares = 0.0;
    for (const Vector3f& p : s.points) {
      const auto off = static_cast<double>(distance_to(kept, level.triangles, level.triangles.size(), p));
      squares += off * off;
      EXPECT_LT(off, 4.0 * static_cast<double>(errors[i]));
    }
    EXPECT_LT(std::sqrt(squares / static_cast<double>(s.points.size())), static_cast<double>(errors[i]));
  }
}

TEST(Simplify, KeepsRidges) {
  const Surface s = sheet(20, 20, [](float x, float) { return std::abs(x - 0.1F); });
  const CoarseSurface coarse = simplify(s.topology, s.points, {0.001F})[0];
  EXPECT_LT(coarse.triangles.size(), s.topology.triangles.size() / 6);
  const std::vector<Vector3f> kept = points_of(coarse, s.points);
  for (const Vector3f& p : s.points) {
    EXPECT_LT(distance_to(kept, coarse.triangles, coarse.triangles.size(), p), 0.003F);
  }
}

TEST(Simplify, FlipsHardlyAnyTriangles) {
  const Surface s = sheet(16, 5, [](float x, float y) { return 0.01F * std::sin(60.F * x) * std::cos(50.F * y); });
  for (const CoarseSurface& level : simplify(s.topology, s.points, {0.0005F, 0.002F, 0.008F})) {
    float all = 0.F, turned = 0.F;
    for (const Triangle& t : level.triangles) {
      const Vector3f& a = s.points[level.vertex[t[0]]];
      const Vector3f up = (s.points[level.vertex[t[1]]] - a).cross(s.points[level.vertex[t[2]]] - a);
      all += up.norm();
      turned += up.z() <= 0.F ? up.norm() : 0.F;
    }
    EXPECT_LE(turned, 0.02F * all);
  }
}

TEST(Simplify, OrdersNeighboursOneAfterTheOther) {
  const Surface s = sphere(40, 80);
  const CoarseSurface coarse = simplify(s.topology, s.points, {0.0005F})[0];
  std::size_t pairs = 0;
  for (std::size_t t = 0; t + 1 < coarse.triangles.size(); t += 2) {
    int shared = 0;
    for (const std::uint32_t a : coarse.triangles[t]) {
      for (const std::uint32_t b : coarse.triangles[t + 1]) shared += a == b ? 1 : 0;
    }
    pairs += shared == 2 ? 1 : 0;
  }
  EXPECT_GT(2 * pairs, coarse.triangles.size() * 4 / 5);
}

}  // namespace

}  // namespace vesalius::synth
