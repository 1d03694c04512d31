#include "synth/body/body_detail.h"

#include <gmock/gmock.h>

#include <cmath>

#include "synth/body/builtin_body.h"
#include "synth/body/test_bodies.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

const Poser& person() {
  static const Poser poser(std::make_shared<const BodyMesh>(make_builtin_body({}, paper_body())), paper_body());
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

}  // namespace
}  // namespace vesalius::synth
