#include "synth/furniture/care.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "synth/furniture/test_furniture.h"

namespace vesalius::synth {
namespace {

using namespace test;
using Eigen::Vector3f;

bool filled(const Furniture& piece, const Vector3f& p) {
  return std::ranges::any_of(piece.solids, [&](const OrientedBox& box) { return depth_inside(box, p) > 0.F; });
}

SeatShape shape_of(Random& random) {
  SeatShape shape;
  shape.height_m = between(0.3, 0.6, random);
  shape.width_m = between(0.36, 0.6, random);
  shape.depth_m = between(0.35, 0.5, random);
  shape.back_m = between(0.3, 0.6, random);
  shape.lean_rad = between(0.0, 0.4, random);
  return shape;
}

std::array<Vector3f, 2> soles_before(const SeatShape& shape, Random& random) {
  std::array<Vector3f, 2> soles;
  for (std::size_t i = 0; i < soles.size(); ++i) {
    const float aside = between(0.06, 0.15, random) * (i == 0 ? 1.F : -1.F);
    soles[i] = {aside, between(0.05, 0.2, random), shape.depth_m + between(0.05, 0.25, random)};
  }
  return soles;
}

TEST(Care, CarriesWhoSitsWhereTheShapeSays) {
  for (int kind = 0; kind < 3; ++kind) {
    for (std::uint64_t i = 0; i < 40; ++i) {
      Random random(61, i);
      const SeatShape shape = shape_of(random);
      const Furniture seat = kind == 0   ? make_wheelchair(shape, soles_before(shape, random), random)
                             : kind == 1 ? make_toilet(shape, random)
                                         : make_bench(shape, random);
      expect_valid(seat.mesh, 5000);
      EXPECT_NEAR(bounds_of(seat.mesh).min().y(), 0.F, 0.02F) << kind << " " << i;
      for (const float x : {-0.1F, 0.1F}) {
        for (const float z : {0.05F, 0.3F}) {
          EXPECT_TRUE(filled(seat, {x, shape.height_m - 0.02F, z})) << kind << " " << i;
          EXPECT_FALSE(filled(seat, {x, shape.height_m + 0.02F, z + 0.01F})) << kind << " " << i;
        }
      }
    }
  }
}

TEST(Care, PutsFootrestsJustBelowTheSoles) {
  for (std::uint64_t i = 0; i < 60; ++i) {
    Random random(62, i);
    const SeatShape shape = shape_of(random);
    const std::array<Vector3f, 2> soles = soles_before(shape, random);
    const Furniture chair = make_wheelchair(shape, soles, random);
    for (const Vector3f& sole : soles) {
      EXPECT_TRUE(filled(chair, sole - Vector3f(0.F, 0.005F, 0.F))) << i;
      EXPECT_FALSE(filled(chair, sole + Vector3f(0.F, 0.002F, 0.F))) << i;
    }
  }
}

TEST(Care, MakesBedsWithRailsAboveTheMattress) {
  int railed = 0;
  constexpr int kBeds = 40;
  for (std::uint64_t i = 0; i < kBeds; ++i) {
    Random random(63, i);
    const float height = between(0.25, 0.7, random);
    const Furniture bed = make_care_bed(0.9F, 2.F, height, random);
    expect_valid(bed.mesh, 5000);
    EXPECT_NEAR(bounds_of(bed.mesh).min().y(), 0.F, 0.02F) << i;
    for (const float z : {-0.8F, 0.F, 0.8F}) {
      EXPECT_TRUE(filled(bed, {0.F, height - 0.02F, z})) << i;
      EXPECT_FALSE(filled(bed, {0.2F, height + 0.01F, z})) << i;
    }
    railed += filled(bed, {0.48F, height + 0.15F, 0.4F}) && filled(bed, {-0.48F, height + 0.15F, 0.4F}) ? 1 : 0;
  }
  EXPECT_GT(railed, kBeds / 2);
  EXPECT_LT(railed, kBeds) << "some have one rail";
}

TEST(Care, GivesHandlesAtTheirHeightToWhatIsPushed) {
  for (const auto make : {make_trolley, make_walker}) {
    for (std::uint64_t i = 0; i < 60; ++i) {
      Random random(64, i);
      const float handle = between(0.7, 1.1, random);
      const Furniture piece = make(handle, random);
      const auto grips = std::ranges::count_if(piece.mesh.vertices, [&](const Vector3f& p) {
        return std::abs(p.y() - handle) < 0.03F && std::abs(p.z()) < 0.06F;
      });
      EXPECT_GE(grips, 8) << i;
      const Eigen::AlignedBox3f bounds = bounds_of(piece.mesh);
      EXPECT_GT(bounds.min().z(), -0.35F) << "hind wheels stand beside the feet";
      EXPECT_GT(bounds.max().z(), 0.3F);
    }
  }
}

}  // namespace
}  // namespace vesalius::synth
