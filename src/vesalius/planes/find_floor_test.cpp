#include "vesalius/planes/find_floor.h"

#include <gmock/gmock.h>

namespace vesalius {
namespace {

Plane plane(const Eigen::Vector3f& normal, float offset) { return {normal.normalized(), offset, 2.F}; }

const Plane kWall = plane({0.F, 0.F, 1.F}, 4.F);
const Plane kCeiling = plane({0.F, -1.F, 0.1F}, 1.2F);
const Plane kTable = plane({0.F, 1.F, 0.2F}, 0.7F);
const Plane kFloor = plane({0.F, 1.F, 0.2F}, 1.4F);

TEST(FindFloor, IsTheLowestLevelPlane) {
  EXPECT_FLOAT_EQ(find_floor({kWall, kCeiling, kTable, kFloor}, std::nullopt)->offset, 1.4F);
  EXPECT_EQ(find_floor({kWall, kCeiling}, std::nullopt), std::nullopt);
  EXPECT_EQ(find_floor({}, std::nullopt), std::nullopt);
}

TEST(FindFloor, FollowsWhatIsKnownOfUp) {
  // A camera on its side: the ground is to the right.
  const Plane right = plane({1.F, 0.F, 0.F}, 1.F);
  EXPECT_EQ(find_floor({right}, std::nullopt), std::nullopt);
  EXPECT_FLOAT_EQ(find_floor({right, kFloor}, Eigen::Vector3f(-1.F, 0.F, 0.F))->offset, 1.F);
}

TEST(FindFloor, IsNoSurfaceOnWhichTheCameraLies) {
  EXPECT_EQ(find_floor({plane({0.F, 1.F, 0.F}, 0.02F)}, std::nullopt), std::nullopt);
}

}  // namespace
}  // namespace vesalius
