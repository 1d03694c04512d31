#include "synth/furniture/pictures.h"

#include <gtest/gtest.h>

#include <set>

#include "synth/furniture/test_furniture.h"

namespace vesalius::synth {
namespace {

using namespace test;
using Eigen::Vector3f;

Furniture picture(std::uint64_t stream) {
  Random random(52, stream);
  return make_picture(random);
}

TEST(Picture, IsFlatWithItsBackToTheWall) {
  for (std::uint64_t i = 0; i < 100; ++i) {
    const Furniture piece = picture(i);
    expect_valid(piece.mesh, 9000);
    const Eigen::AlignedBox3f bounds = bounds_of(piece.mesh);
    EXPECT_EQ(bounds.min().z(), 0.F);
    EXPECT_LT(bounds.max().z(), 0.06F);
    EXPECT_GE(bounds.min().y(), 0.F);
    EXPECT_LT(bounds.max().y(), 2.3F) << "the lowest ceiling";
    ASSERT_EQ(piece.solids.size(), 1U);
    for (const Vector3f& p : piece.mesh.vertices) EXPECT_GT(depth_inside(piece.solids[0], p), -0.003F) << i;
  }
}

TEST(Picture, CoversItsFaceOnceInSeveralColours) {
  for (std::uint64_t i = 0; i < 100; ++i) {
    const Furniture piece = picture(i);
    const float front = bounds_of(piece.mesh).max().z();
    Eigen::AlignedBox3f face;
    double area = 0.0;
    std::set<std::uint8_t> inks;
    for (std::size_t t = 0; t < piece.mesh.triangles.size(); ++t) {
      const auto corner = [&](int k) { return piece.mesh.vertices[piece.mesh.triangles[t][k]]; };
      if (corner(0).z() < front || corner(1).z() < front || corner(2).z() < front) continue;
      const Vector3f across = (corner(1) - corner(0)).cross(corner(2) - corner(0));
      EXPECT_GT(across.z(), 0.F) << "seen from in front";
      area += 0.5 * across.z();
      inks.insert(piece.mesh.material[t]);
      for (int k = 0; k < 3; ++k) face.extend(corner(k));
    }
    EXPECT_NEAR(area, face.sizes().x() * face.sizes().y(), 1e-3) << i;
    EXPECT_GE(inks.size(), 3U) << i;
  }
}

TEST(Picture, SendsBackNextToNothingWhereItIsAScreen) {
  int dark = 0;
  constexpr int kPictures = 200;
  for (std::uint64_t i = 0; i < kPictures; ++i) dark += picture(i).mesh.materials.back().infrared < 0.13F ? 1 : 0;
  EXPECT_GT(dark, kPictures / 6);
  EXPECT_LT(dark, kPictures / 3);
}

TEST(Picture, IsTheSameForTheSameSeed) {
  EXPECT_EQ(picture(1).mesh.vertices, picture(1).mesh.vertices);
  EXPECT_NE(picture(1).mesh.vertices, picture(2).mesh.vertices);
}

}  // namespace
}  // namespace vesalius::synth
