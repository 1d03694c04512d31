#include "synth/body/surface_nets.h"

#include <gmock/gmock.h>

#include "synth/body/test_bodies.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

Limb ball(const Vector3f& centre, float radius, bool paired) {
  return {{{centre, radius, radius, radius}}, Vector3f::UnitX(), Vector3f::UnitY(), {}, paired};
}

HalfGrid grid(float step) {
  HalfGrid out;
  for (float x = -step / 2.F; x < 0.6F; x += step) out.lines[0].push_back(x);
  for (float y = -0.6F; y < 0.6F; y += step) out.lines[1].push_back(y);
  out.lines[2] = out.lines[1];
  return out;
}

TEST(SurfaceNets, GiveABallItsRadius) {
  const Surface surface = melt({ball(Vector3f::Zero(), 0.3F, false)}, 0.01F, grid(0.02F));
  EXPECT_TRUE(is_closed(surface.triangles, surface.triangles.size()));
  for (const Vector3f& p : surface.vertices) EXPECT_NEAR(p.norm(), 0.3F, 0.004F);
  double volume = 0.0;
  for (const Triangle& t : surface.triangles) {
    volume +=
        static_cast<double>(surface.vertices[t[0]].dot(surface.vertices[t[1]].cross(surface.vertices[t[2]]))) / 6.0;
  }
  EXPECT_NEAR(volume, 4.0 / 3.0 * 3.14159 * 0.027, 0.003);  // positive if triangles face outwards
}

TEST(SurfaceNets, TurnAPairedLimbIntoTwoMirrorImages) {
  const Surface surface = melt({ball({0.3F, 0.F, 0.1F}, 0.15F, true)}, 0.01F, grid(0.02F));
  EXPECT_TRUE(is_closed(surface.triangles, surface.triangles.size()));
  for (const Vector3f& p : surface.vertices) {
    EXPECT_NEAR((Vector3f(std::abs(p.x()), p.y(), p.z()) - Vector3f(0.3F, 0.F, 0.1F)).norm(), 0.15F, 0.004F);
  }
  const std::size_t half = surface.triangles.size() / 2;
  for (std::size_t t = 0; t < half; ++t) {
    const Vector3f& p = surface.vertices[surface.triangles[t][0]];
    const Vector3f& q = surface.vertices[surface.triangles[t + half][2]];
    ASSERT_EQ(p, Vector3f(-q.x(), q.y(), q.z()));
    ASSERT_GT(p.x(), 0.F);
  }
}

TEST(SurfaceNets, MeltPairsThatMeetIntoOneSurface) {
  const Surface surface = melt({ball({0.1F, 0.F, 0.F}, 0.2F, true)}, 0.02F, grid(0.02F));
  EXPECT_TRUE(is_closed(surface.triangles, surface.triangles.size()));
  EXPECT_TRUE(is_inside(surface.vertices, surface.triangles, surface.triangles.size(), {0.001F, 0.001F, 0.F}));
  EXPECT_TRUE(std::ranges::any_of(surface.vertices, [](const Vector3f& p) { return p.x() == 0.F; }));
}

TEST(Limb, HasTheDistanceOfARoundCone) {
  Limb limb;
  limb.stations = {{{0.F, 0.F, 0.F}, 0.1F, 0.1F, 0.1F}, {{0.F, 1.F, 0.F}, 0.2F, 0.2F, 0.2F}};
  const LimbDistance distance(limb);
  EXPECT_NEAR(distance.nearest({0.5F, 0.F, 0.F}).distance_m, 0.4F, 1e-5F);
  EXPECT_NEAR(distance.nearest({0.5F, 0.5F, 0.F}).distance_m, 0.35F, 1e-5F);
  EXPECT_NEAR(distance.nearest({0.F, 1.5F, 0.F}).distance_m, 0.3F, 1e-5F);
  EXPECT_NEAR(distance.nearest({0.F, -0.4F, 0.F}).distance_m, 0.3F, 1e-5F);
  EXPECT_NEAR(distance.nearest({0.3F, 0.7F, 0.F}).along_m, 0.7F, 1e-5F);
  EXPECT_LT(distance.nearest({0.01F, 0.5F, 0.F}).distance_m, -0.1F);
}

TEST(Limb, FindsTheNearestOfAllPieces) {
  Random random(3);
  Limb limb;
  for (int k = 0; k < 6; ++k) {
    limb.stations.push_back({{static_cast<float>(random.uniform(-0.1, 0.1)), 0.2F * static_cast<float>(k), 0.F},
                             static_cast<float>(random.uniform(0.05, 0.1)),
                             static_cast<float>(random.uniform(0.05, 0.1)),
                             0.05F});
  }
  const LimbDistance whole(limb);
  for (int i = 0; i < 500; ++i) {
    const Vector3f p(static_cast<float>(random.uniform(-0.5, 0.5)), static_cast<float>(random.uniform(-0.3, 1.3)),
                     static_cast<float>(random.uniform(-0.5, 0.5)));
    float best = 9.F;
    for (std::size_t k = 1; k < limb.stations.size(); ++k) {
      Limb piece = limb;
      piece.stations = {limb.stations[k - 1], limb.stations[k]};
      best = std::min(best, LimbDistance(piece).nearest(p).distance_m);
    }
    EXPECT_NEAR(whole.nearest(p).distance_m, best, 1e-5F);
  }
}

}  // namespace
}  // namespace vesalius::synth
