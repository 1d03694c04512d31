#include "synth/scene/room.h"

#include <gtest/gtest.h>

#include "synth/sensor/render.h"

namespace vesalius::synth {
namespace {

using Eigen::Vector3f;

RoomShape turned_room() {
  RoomShape room;
  room.world_from_room = Eigen::Translation3f(1.F, 0.F, -2.F) * Eigen::AngleAxisf(0.4F, Vector3f::UnitY());
  room.low = {-2.F, -1.5F};
  room.high = {3.F, 4.F};
  room.height_m = 2.6F;
  return room;
}

TEST(Room, HasTheDistanceToTheNearestSurfaceAsClearance) {
  const RoomShape room = turned_room();
  EXPECT_NEAR(clearance(room, room.world_from_room * Vector3f(0.F, 1.2F, 0.F)), 1.2F, 1e-5F);
  EXPECT_NEAR(clearance(room, room.world_from_room * Vector3f(2.9F, 1.2F, 0.F)), 0.1F, 1e-5F);
  EXPECT_NEAR(clearance(room, room.world_from_room * Vector3f(0.F, 1.2F, -1.6F)), -0.1F, 1e-5F);
  EXPECT_NEAR(clearance(room, room.world_from_room * Vector3f(0.F, 2.5F, 0.F)), 0.1F, 1e-5F);
}

TEST(Room, IsClosedExceptForItsWindows) {
  const RoomShape room = turned_room();
  Renderer renderer;
  int holes = 0, pixels = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Random random(9, seed);
    Scene scene;
    scene.meshes = {make_room(room, random)};
    for (int turn = 0; turn < 8; ++turn) {
      View view;
      view.camera = {80, 60, 40.F, 40.F, 39.5F, 29.5F};
      Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
      pose.linear() = Eigen::AngleAxisf(0.7854F * static_cast<float>(turn), Vector3f::UnitY()) *
                      Eigen::AngleAxisf(3.1415927F, Vector3f::UnitX()).toRotationMatrix();
      pose.translation() = room.world_from_room * Vector3f(0.5F, 1.4F, 1.F);
      view.camera_from_world = pose.inverse();
      const Rendering out = renderer.render(scene, view);
      for (int v = 0; v < 60; ++v) {
        for (int u = 0; u < 80; ++u) {
          const float z = out.depth_m(u, v);
          ++pixels;
          holes += z == 0.F ? 1 : 0;
          if (z == 0.F) continue;
          const Vector3f p = pose * view.camera.point(static_cast<float>(u), static_cast<float>(v), z);
          // Frames, skirting and curtains are in front of the walls, corridors behind them.
          ASSERT_LT(clearance(room, p), 0.2F);
          ASSERT_GT(clearance(room, p), -2.6F);
        }
      }
    }
  }
  EXPECT_GT(holes, 0);
  EXPECT_LT(holes, pixels / 4);
}

TEST(Room, IsOnlyAFloorInAnOpenHall) {
  RoomShape room;
  room.open = true;
  Random random(1);
  const SceneMesh mesh = make_room(room, random);
  for (const Vector3f& p : mesh.vertices) EXPECT_EQ(p.y(), 0.F);
  EXPECT_EQ(clearance(room, {100.F, 0.7F, 3.F}), 0.7F);
}

}  // namespace
}  // namespace vesalius::synth
