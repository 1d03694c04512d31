#include "synth/furniture/nobody.h"

#include <gtest/gtest.h>

#include "synth/furniture/test_furniture.h"
#include "synth/scene/test_plans.h"

namespace vesalius::synth {
namespace {

using namespace test;
using Eigen::Vector3f;

class EveryNobody : public testing::TestWithParam<int> {
 protected:
  NobodyKind kind() const { return static_cast<NobodyKind>(GetParam()); }
  Furniture make(std::uint64_t stream) const {
    Random random(14, stream);
    return make_nobody(kind(), random);
  }
};

TEST_P(EveryNobody, StandsOnTheFloorOrHangs) {
  for (std::uint64_t i = 0; i < 60; ++i) {
    const Eigen::AlignedBox3f bounds = bounds_of(make(i).mesh);
    if (hangs_on_wall(kind())) {
      EXPECT_GT(bounds.min().y(), 0.05F) << i;
      EXPECT_LT(bounds.max().y(), 2.F) << i;
      EXPECT_GT(bounds.min().z(), -0.05F) << "nothing is in the wall";
    } else {
      EXPECT_NEAR(bounds.min().y(), 0.F, 0.035F) << i;
    }
    EXPECT_GT(bounds.sizes().maxCoeff(), 0.3F);
    EXPECT_LT(bounds.sizes().maxCoeff(), 3.F);
  }
}

TEST_P(EveryNobody, HasAValidMeshOfFewTriangles) {
  for (std::uint64_t i = 0; i < 60; ++i) {
    expect_valid(make(i).mesh, 6000);
  }
}

TEST_P(EveryNobody, HasSolidsWithinItsMesh) {
  for (std::uint64_t i = 0; i < 60; ++i) {
    const Furniture piece = make(i);
    ASSERT_FALSE(piece.solids.empty());
    Eigen::AlignedBox3f bounds = bounds_of(piece.mesh);
    bounds.min().array() -= 0.09F;  // the solids of boards are thicker than the boards
    bounds.max().array() += 0.09F;
    for (const OrientedBox& box : piece.solids) {
      for (const Vector3f& corner : corners(box)) EXPECT_TRUE(bounds.contains(corner)) << i;
    }
  }
}

TEST_P(EveryNobody, IsTheSameForTheSameSeed) {
  EXPECT_EQ(make(1).mesh.vertices, make(1).mesh.vertices);
  EXPECT_NE(make(1).mesh.vertices, make(2).mesh.vertices);
}

INSTANTIATE_TEST_SUITE_P(Nobody, EveryNobody, testing::Range(0, kNobodyKindCount));

/// Returns the mean number of triangles of empty rooms apart from the rooms themselves.
double triangles_of_furniture(const SceneOptions& options) {
  double sum = 0.0;
  constexpr int kScenes = 30;
  for (std::uint64_t i = 0; i < kScenes; ++i) {
    const BuiltScene built = build_scene(options, {}, kCamera, {}, Random(15, i));
    for (std::size_t m = 1; m < built.scene.meshes.size(); ++m) {
      sum += static_cast<double>(built.scene.meshes[m].triangles.size());
    }
  }
  return sum / kScenes;
}

TEST(Nobody, StandsInEmptyRoomsByItsShareAndNearTheCamera) {
  SceneOptions options;
  options.furniture_min = options.furniture_max = 4;
  options.near_probability = 0.F;
  const double usual = triangles_of_furniture(options);
  options.nobody_share = 1.F;
  EXPECT_GT(triangles_of_furniture(options), 2.0 * usual) << "folds and cushions have more triangles than boxes";
  options = {};
  options.furniture_min = options.furniture_max = 0;
  options.near_probability = 1.F;
  const double near = triangles_of_furniture(options);
  options.near_nobody_share = 1.F;
  EXPECT_GT(triangles_of_furniture(options), near);
}

}  // namespace
}  // namespace vesalius::synth
