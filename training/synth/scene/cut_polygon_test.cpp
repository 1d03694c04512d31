#include "synth/scene/cut_polygon.h"

#include <gtest/gtest.h>

#include <cmath>

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

Vector3f doubled_area(const Vector3f& a, const Vector3f& b, const Vector3f& c) { return (b - a).cross(c - a); }

/// Expects n - 2 triangles with the polygon's orientation whose areas add up to its own.
void expect_covered(const std::vector<Vector3f>& corners, float area) {
  const std::vector<Triangle> triangles = cut_polygon(corners);
  ASSERT_EQ(triangles.size(), corners.size() - 2);
  float sum = 0.F;
  for (const Triangle& t : triangles) {
    const float doubled = doubled_area(corners[t[0]], corners[t[1]], corners[t[2]]).z();
    EXPECT_GE(doubled, 0.F);
    sum += doubled / 2.F;
  }
  EXPECT_NEAR(sum, area, 1e-4F * area);
}

TEST(CutPolygon, CoversConvexAndConcavePolygonsOnce) {
  expect_covered({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 0.5F);
  expect_covered({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, 1.F);
  expect_covered({{0, 0, 0}, {2, 0, 0}, {0.5F, 0.5F, 0}, {0, 2, 0}}, 1.F);  // an arrowhead
  expect_covered({{0, 0, 0}, {3, 0, 0}, {3, 2, 0}, {2, 2, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}}, 5.F);  // a U
}

TEST(CutPolygon, CoversAStar) {
  std::vector<Vector3f> corners;
  constexpr int kPoints = 64;
  for (int i = 0; i < kPoints; ++i) {
    const float turn = 6.2831853F * float(i) / kPoints, radius = i % 2 == 0 ? 1.F : 0.4F;
    corners.emplace_back(radius * std::cos(turn), radius * std::sin(turn), 0.F);
  }
  expect_covered(corners, kPoints / 2 * 0.4F * std::sin(6.2831853F / kPoints));
}

TEST(CutPolygon, CutsPolygonsWithoutArea) {
  EXPECT_EQ(cut_polygon(std::vector<Vector3f>(5, Vector3f::Zero())).size(), 3U);
  EXPECT_EQ(cut_polygon({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}).size(), 2U);  // crosses itself
}

}  // namespace
}  // namespace vesalius::synth
