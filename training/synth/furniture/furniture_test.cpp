#include <gtest/gtest.h>

#include <cmath>

#include "synth/furniture/make_furniture.h"
#include "synth/furniture/seats.h"
#include "synth/furniture/test_furniture.h"

namespace vesalius::synth {
namespace {

using namespace test;
using Eigen::Vector3f;

class EveryKind : public testing::TestWithParam<int> {
 protected:
  Furniture make(std::uint64_t stream) const {
    Random random(4, stream);
    return make_furniture(static_cast<FurnitureKind>(GetParam()), random);
  }
};

TEST_P(EveryKind, StandsOnTheFloorAndIsOfHumanSize) {
  for (std::uint64_t i = 0; i < 60; ++i) {
    const Furniture piece = make(i);
    const Eigen::AlignedBox3f bounds = bounds_of(piece.mesh);
    EXPECT_NEAR(bounds.min().y(), 0.F, 0.035F) << i;
    EXPECT_GE(bounds.min().y(), -0.02F);
    EXPECT_GT(bounds.sizes().maxCoeff(), 0.15F);
    EXPECT_LT(bounds.sizes().maxCoeff(), 3.6F);
    EXPECT_LT(bounds.center().head<1>().norm(), 0.3F);
  }
}

TEST_P(EveryKind, HasAValidMesh) {
  for (std::uint64_t i = 0; i < 60; ++i) {
    expect_valid(make(i).mesh, 3000);
  }
}

TEST_P(EveryKind, HasSolidsThatFillItsMesh) {
  for (std::uint64_t i = 0; i < 60; ++i) {
    const Furniture piece = make(i);
    ASSERT_FALSE(piece.solids.empty());
    Eigen::AlignedBox3f solid;
    for (const OrientedBox& box : piece.solids) {
      EXPECT_GT(box.half.minCoeff(), 0.F);
      for (const Vector3f& corner : corners(box)) solid.extend(corner);
    }
    Eigen::AlignedBox3f bounds = bounds_of(piece.mesh);
    bounds.min().array() -= 0.09F;  // the solids of boards are thicker than the boards
    bounds.max().array() += 0.09F;
    EXPECT_TRUE(bounds.contains(solid)) << i;
    EXPECT_GT(solid.volume(), 0.15F * bounds_of(piece.mesh).volume()) << i;
  }
}

TEST_P(EveryKind, IsTheSameForTheSameSeed) {
  EXPECT_EQ(make(1).mesh.vertices, make(1).mesh.vertices);
  EXPECT_NE(make(1).mesh.vertices, make(2).mesh.vertices);
}

INSTANTIATE_TEST_SUITE_P(Furniture, EveryKind, testing::Range(0, static_cast<int>(FurnitureKind::panel) + 1));

TEST(Furniture, HasSeatsWhereTheShapeSays) {
  for (const SeatKind kind : {SeatKind::chair, SeatKind::stool, SeatKind::armchair, SeatKind::sofa}) {
    for (std::uint64_t i = 0; i < 20; ++i) {
      Random random(5, i);
      const SeatShape shape{kind, 0.43F, kind == SeatKind::sofa ? 1.6F : 0.5F, 0.46F, 0.5F, 0.15F};
      const Furniture seat = make_seat(shape, random);
      const auto filled = [&](const Vector3f& p) {
        for (const OrientedBox& box : seat.solids) {
          if (depth_inside(box, p) > 0.F) return true;
        }
        return false;
      };
      for (const float x : {-0.15F, 0.15F}) {
        for (const float z : {0.05F, 0.44F}) {
          EXPECT_TRUE(filled({x, 0.42F, z}));
          EXPECT_FALSE(filled({x, 0.44F, z + 0.01F}));
        }
      }
      if (kind == SeatKind::stool) continue;
      const float up = 0.4F;  // distance along the back
      const Vector3f on_back(0.F, 0.43F + up * std::cos(0.15F), -up * std::sin(0.15F));
      EXPECT_TRUE(filled(on_back - Vector3f(0.F, 0.F, 0.015F)));
      EXPECT_FALSE(filled(on_back + Vector3f(0.F, 0.F, 0.015F)));
    }
  }
}

TEST(Furniture, HasBedsThatCarryAtTheirHeight) {
  Random random(6);
  const Furniture bed = make_bed(1.F, 2.F, 0.5F, random);
  float top = 0.F;
  for (const OrientedBox& box : bed.solids) {
    if (depth_inside(box, {0.3F, 0.49F, -0.5F}) > 0.F) top = 0.5F;
    EXPECT_LT(depth_inside(box, {0.3F, 0.51F, -0.5F}), 0.F);
  }
  EXPECT_EQ(top, 0.5F);
}

TEST(Furniture, MovesSolidsWithTheMesh) {
  Random random(7);
  Furniture table = make_table(1.F, 0.6F, 0.7F, random);
  const OrientedBox before = table.solids[0];
  const Vector3f vertex = table.mesh.vertices[0];
  const Eigen::Isometry3f pose = standing_at(1.F, 0.F, 2.F, 0.8F);
  move(table, pose);
  EXPECT_TRUE(table.mesh.vertices[0].isApprox(pose * vertex));
  EXPECT_TRUE(table.solids[0].pose.isApprox(pose * before.pose));
}

}  // namespace
}  // namespace vesalius::synth
