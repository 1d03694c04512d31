#include "synth/furniture/gear.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "synth/furniture/test_furniture.h"

namespace vesalius::synth {
namespace {

using namespace test;
using Eigen::Vector3f;

Furniture gear(GearKind kind, std::uint64_t stream) {
  Random random(51, stream);
  return make_gear(kind, random);
}

class EveryGear : public testing::TestWithParam<int> {
 protected:
  Furniture make(std::uint64_t stream) const { return gear(static_cast<GearKind>(GetParam()), stream); }
};

TEST_P(EveryGear, StandsOnTheFloorAndIsOfHumanSize) {
  for (std::uint64_t i = 0; i < 100; ++i) {
    const Furniture piece = make(i);
    expect_valid(piece.mesh, 9000);
    const Eigen::AlignedBox3f bounds = bounds_of(piece.mesh);
    EXPECT_NEAR(bounds.min().y(), 0.F, 0.02F) << i;
    EXPECT_GT(bounds.sizes().maxCoeff(), 0.4F) << i;
    EXPECT_LT(bounds.sizes().maxCoeff(), 2.9F) << i;
    EXPECT_LT(std::hypot(bounds.center().x(), bounds.center().z()), 0.75F) << "a machine reaches out to one side";
  }
}

TEST_P(EveryGear, HasSolidsWithinAndAboutItsMesh) {
  for (std::uint64_t i = 0; i < 60; ++i) {
    const Furniture piece = make(i);
    ASSERT_FALSE(piece.solids.empty());
    ASSERT_LT(piece.solids.size(), 60U) << "each is compared with all others of a room";
    Eigen::AlignedBox3f bounds = bounds_of(piece.mesh);
    bounds.min().array() -= 0.09F;  // the solids of boards are thicker than the boards
    bounds.max().array() += 0.09F;
    for (const OrientedBox& box : piece.solids) {
      for (const Vector3f& corner : corners(box)) EXPECT_TRUE(bounds.contains(corner)) << i;
    }
    const auto covered = std::ranges::count_if(piece.mesh.vertices, [&](const Vector3f& p) {
      return std::ranges::any_of(piece.solids, [&](const OrientedBox& box) { return depth_inside(box, p) > -0.2F; });
    });
    EXPECT_GT(double(covered), 0.65 * double(piece.mesh.vertices.size())) << i << ": cables and handles stand out";
  }
}

TEST_P(EveryGear, IsTheSameForTheSameSeed) {
  EXPECT_EQ(make(1).mesh.vertices, make(1).mesh.vertices);
  EXPECT_NE(make(1).mesh.vertices, make(2).mesh.vertices);
}

INSTANTIATE_TEST_SUITE_P(Gear, EveryGear, testing::Range(0, kGearKindCount));

TEST(Gear, HasSwivelChairsOnFiveFeet) {
  constexpr int kChairs = 100;
  int upright = 0;
  for (std::uint64_t i = 0; i < kChairs; ++i) {
    std::set<int> feet;
    for (const Vector3f& p : gear(GearKind::swivel_chair, i).mesh.vertices) {
      if (p.y() > 0.01F || std::hypot(p.x(), p.z()) < 0.2F) continue;
      const float fifths = std::atan2(p.z(), p.x()) / (2.F * std::numbers::pi_v<float>)*50.F;
      feet.insert((static_cast<int>(std::lround(fifths)) + 50) % 50);
    }
    int gaps = 0;  // between bunches of directions in which something touches the floor
    for (int k = 0; k < 50; ++k) gaps += feet.contains(k) && !feet.contains((k + 1) % 50) ? 1 : 0;
    upright += gaps == 5 ? 1 : 0;
  }
  EXPECT_GT(upright, kChairs * 3 / 4);
  EXPECT_LT(upright, kChairs) << "some lie on their side";
}

TEST(Gear, IsBlackInParts) {
  for (const GearKind kind : {GearKind::swivel_chair, GearKind::monitors}) {
    int black = 0;
    for (std::uint64_t i = 0; i < 60; ++i) {
      const Furniture piece = gear(kind, i);
      black += std::ranges::any_of(piece.mesh.materials, [](const Material& m) { return m.infrared < 0.03F; }) ? 1 : 0;
    }
    EXPECT_GT(black, 20);
    EXPECT_LT(black, 60);
  }
}

}  // namespace
}  // namespace vesalius::synth
