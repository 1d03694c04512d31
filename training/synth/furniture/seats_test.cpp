#include "synth/furniture/seats.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

SeatShape sofa_shape() {
  SeatShape shape;
  shape.kind = SeatKind::sofa;
  shape.width_m = 1.8F;
  shape.lean_rad = 0.F;
  return shape;
}

/// Returns the highest of the points whose x and z are near the given ones; minus infinity if there are none.
float height_at(const SceneMesh& mesh, float x, float z, float reach_m) {
  float highest = -std::numeric_limits<float>::infinity();
  for (const Vector3f& p : mesh.vertices) {
    if (std::abs(p.x() - x) < reach_m && std::abs(p.z() - z) < reach_m) highest = std::max(highest, p.y());
  }
  return highest;
}

TEST(SoftSupport, SwellsAboveTheSeatAndIsNoSolid) {
  constexpr float kSwell_m = 0.06F;
  for (std::uint64_t i = 0; i < 20; ++i) {
    Random random(31, i);
    const SeatShape shape = sofa_shape();
    Furniture sofa = make_seat(shape, random);
    const std::size_t solids = sofa.solids.size(), before = sofa.mesh.vertices.size();
    add_seat_cushions(shape, kSwell_m, sofa, random);
    EXPECT_EQ(sofa.solids.size(), solids);
    float highest = 0.F, foremost = 0.F;
    for (std::size_t v = before; v < sofa.mesh.vertices.size(); ++v) {
      const Vector3f& p = sofa.mesh.vertices[v];
      if (p.z() > 0.42F) highest = std::max(highest, p.y());
      if (p.y() > shape.height_m + 0.2F && p.z() < 0.2F) foremost = std::max(foremost, p.z());
    }
    EXPECT_LE(highest, shape.height_m + kSwell_m + 1e-4F);
    EXPECT_GE(highest, shape.height_m + 0.6F * kSwell_m);
    EXPECT_GE(foremost, 0.9F * kSwell_m) << "the back swells as well";
  }
}

TEST(SoftSupport, MakesBedsThatSwell) {
  Random random(32);
  Furniture bed = make_bed(1.F, 2.F, 0.5F, random);
  const std::size_t before = bed.mesh.vertices.size();
  add_soft_mattress(1.F, 2.F, 0.5F, 0.05F, bed, random);
  float highest = 0.F;
  for (std::size_t v = before; v < bed.mesh.vertices.size(); ++v) highest = std::max(highest, bed.mesh.vertices[v].y());
  EXPECT_NEAR(highest, 0.55F, 1e-3F);
}

TEST(Blanket, CoversWhatLiesBelowItAndRestsOnTheGround) {
  std::vector<Vector3f> body;
  for (float z = -0.6F; z < 0.5F; z += 0.02F) body.emplace_back(0.1F, 0.7F, z);
  body.emplace_back(-0.2F, 1.5F, 0.F);  // a raised hand
  const BlanketPlace place{.low = {-0.5F, -0.8F}, .high = {0.5F, 0.3F}, .ground_m = 0.5F, .top_m = 1.F};
  for (std::uint64_t i = 0; i < 10; ++i) {
    Random random(33, i);
    const SceneMesh blanket = drape_blanket(place, body, random);
    for (const Vector3f& p : body) {
      if (p.y() > place.top_m || p.z() > place.high.y() - 0.05F) continue;
      EXPECT_GT(height_at(blanket, p.x(), p.z(), 0.03F), p.y());
      EXPECT_LT(height_at(blanket, p.x(), p.z(), 0.03F), p.y() + 0.08F);
    }
    EXPECT_NEAR(height_at(blanket, -0.4F, -0.4F, 0.03F), 0.525F, 0.026F) << "aside, it lies on the bed";
    for (const Vector3f& p : blanket.vertices) {
      EXPECT_GE(p.y(), place.ground_m);
      EXPECT_LE(p.z(), place.high.y() + 1e-4F);
    }
    for (const Triangle& t : blanket.triangles) {
      for (const std::uint32_t corner : t) ASSERT_LT(corner, blanket.vertices.size());
    }
  }
}

TEST(Blanket, HangsDownBeyondTheEdge) {
  Random random(34);
  const BlanketPlace place{.low = {-0.3F, 0.F}, .high = {0.3F, 0.8F}, .ground_m = 0.45F, .edge_z = 0.4F};
  const SceneMesh blanket = drape_blanket(place, {}, random);
  EXPECT_GE(height_at(blanket, 0.F, 0.2F, 0.03F), 0.45F);
  EXPECT_LT(height_at(blanket, 0.F, 0.7F, 0.03F), 0.4F);
}

}  // namespace
}  // namespace vesalius::synth
