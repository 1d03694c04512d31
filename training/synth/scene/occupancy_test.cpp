#include "synth/scene/occupancy.h"

#include <gtest/gtest.h>

#include "synth/furniture/furniture.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

/// Returns a stick of 1.8 m about the origin; every bone lies on it.
BodyOutline stick(float x_m, float z_m) {
  PosedBody body;
  for (int i = 0; i <= 180; ++i) body.vertices.emplace_back(x_m, 0.01F * static_cast<float>(i), z_m);
  for (std::size_t b = 0; b < kBoneCount; ++b) {
    body.joints[b] = {x_m, 0.09F * static_cast<float>(b), z_m};
    body.ends[b] = {x_m, 0.09F * static_cast<float>(b) + 0.09F, z_m};
  }
  BodyOutline outline = outline_of(body, 1.8F);
  outline.bounds.min().array() -= 0.12F;  // as if there were flesh
  outline.bounds.max().array() += 0.12F;
  return outline;
}

std::vector<OrientedBox> cube_at(const Vector3f& centre, float half_m) {
  OrientedBox box;
  box.pose = Eigen::Isometry3f(Eigen::Translation3f(centre));
  box.half = Vector3f::Constant(half_m);
  return {box};
}

TEST(Occupancy, LetsBodiesTouchThingsButNotSinkIn) {
  const BodyOutline body = stick(0.F, 0.F);
  EXPECT_FALSE(sinks_in(body, cube_at({0.52F, 1.F, 0.F}, 0.5F)));
  EXPECT_FALSE(sinks_in(body, cube_at({0.48F, 1.F, 0.F}, 0.5F)));  // 2 cm
  EXPECT_TRUE(sinks_in(body, cube_at({0.46F, 1.F, 0.F}, 0.5F)));   // 4 cm
  EXPECT_FALSE(sinks_in(body, cube_at({0.46F, 2.6F, 0.F}, 0.5F)));
}

TEST(Occupancy, KeepsLimbsFromPassingThroughAThinBoard) {
  std::vector<OrientedBox> board = cube_at({0.F, 1.F, 0.F}, 0.5F);
  board[0].half.y() = 0.03F;
  EXPECT_TRUE(sinks_in(stick(0.F, 0.F), board));
}

TEST(Occupancy, KeepsBodiesApart) {
  EXPECT_FALSE(sinks_in(stick(0.F, 0.F), stick(0.4F, 0.F)));
  EXPECT_TRUE(sinks_in(stick(0.F, 0.F), stick(0.1F, 0.05F)));
  EXPECT_TRUE(sinks_in(moved(stick(0.4F, 0.F), standing_at(-0.35F, 0.F, 0.F, 0.F)), stick(0.F, 0.F)));
}

TEST(Occupancy, RefusesPlacesNearOthersTheCameraOrWalls) {
  Occupancy occupancy;
  occupancy.set_eye({0.F, 1.F, 3.F});
  RoomShape room;
  room.low = {-4.F, -4.F};
  room.high = {4.F, 4.F};
  occupancy.set_room(room);
  EXPECT_TRUE(occupancy.free_for(cube_at({0.F, 0.5F, 0.F}, 0.5F)));
  EXPECT_FALSE(occupancy.free_for(cube_at({0.F, 0.5F, 2.5F}, 0.5F)));  // camera
  EXPECT_FALSE(occupancy.free_for(cube_at({3.7F, 0.5F, 0.F}, 0.5F)));  // wall
  EXPECT_FALSE(occupancy.free_for(stick(0.05F, 2.95F)));               // camera
  occupancy.add(cube_at({0.F, 0.5F, 0.F}, 0.5F));
  EXPECT_FALSE(occupancy.free_for(cube_at({0.9F, 0.5F, 0.F}, 0.5F)));
  EXPECT_TRUE(occupancy.free_for(cube_at({1.01F, 0.5F, 0.F}, 0.5F)));
  EXPECT_FALSE(occupancy.free_for(stick(0.3F, 0.F)));
  occupancy.add(stick(-2.F, 0.F));
  EXPECT_FALSE(occupancy.free_for(stick(-2.1F, 0.F)));
  EXPECT_FALSE(occupancy.free_for(cube_at({-2.F, 0.5F, 0.F}, 0.3F)));
}

TEST(Occupancy, TellsHowMuchOfAPersonWouldBeHidden) {
  Occupancy occupancy;
  occupancy.set_eye({0.F, 0.9F, 3.F});
  occupancy.add(stick(0.F, 0.F));
  EXPECT_EQ(occupancy.hidden_share(cube_at({1.F, 0.9F, 1.5F}, 0.4F)), 0.F);
  EXPECT_EQ(occupancy.hidden_share(cube_at({0.F, 0.9F, 1.5F}, 1.F)), 1.F);
  EXPECT_NEAR(occupancy.hidden_share(cube_at({0.F, 0.4F, 1.5F}, 0.5F)), 0.5F, 0.1F);
  EXPECT_EQ(occupancy.hidden_share(cube_at({0.F, 0.9F, -1.5F}, 1.F)), 0.F);  // behind
}

}  // namespace
}  // namespace vesalius::synth
