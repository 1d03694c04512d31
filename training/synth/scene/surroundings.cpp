#include "synth/scene/surroundings.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "synth/mesh/palette.h"

namespace vesalius::synth {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;

}  // namespace

RoomShape draw_room(const SceneOptions& options, const PlacedGroup* first, const ExtentOf& extent_of, Random& random) {
  constexpr float kWallGap_m = 0.02F, kSmallest_m = 1.8F;
  RoomShape room;
  room.open = chance(options.open_share, random);
  float yaw = between(-std::numbers::pi / 4, std::numbers::pi / 4, random);
  if (first != nullptr && chance(0.5, random)) {  // furniture in use often stands parallel to the walls
    const Vector3f front = first->world_from_group.linear().col(2);
    yaw = std::atan2(front.x(), front.z());
  }
  room.world_from_room = Isometry3f(Eigen::AngleAxisf(yaw, Vector3f::UnitY()));
  const bool wall_behind = first != nullptr && asked(options.wall_probability, random);
  if (wall_behind) {  // the room's back wall is where the camera sees the first people
    room.open = false;
    const Vector3f at = first->world_from_group.translation();
    room.world_from_room =
        Isometry3f(Eigen::AngleAxisf(std::atan2(-at.x(), -at.z()) + between(-0.4, 0.4, random), Vector3f::UnitY()));
  }
  const Isometry3f room_from_world = room.world_from_room.inverse();
  Eigen::AlignedBox3f extent = extent_of(room_from_world);
  if (!wall_behind) extent.extend(room_from_world * Vector3f(0.F, 0.F, -between(1.5, 5.0, random)));
  const auto spare = [&] { return kWallGap_m + (chance(0.25, random) ? 0.F : between(0.0, 3.0, random)); };
  const float left = spare();
  const float back = wall_behind ? kWallGap_m + between(0.0, options.wall_gap_max_m, random) : spare();
  const float right = spare(), front = spare();
  room.low = {extent.min().x() - left, extent.min().z() - back};
  room.high = {extent.max().x() + right, extent.max().z() + front};
  room.high = room.high.cwiseMax(room.low + Eigen::Vector2f::Constant(kSmallest_m));
  room.height_m = std::max(between(2.3, 3.2, random), extent.max().y() + 0.05F);
  return room;
}

void add_lights(const RoomShape& room, Scene& scene, Random& random) {
  constexpr float kFromWall_m = 0.5F;
  scene.ambient = between(0.3, 0.6, random);
  const int count = 1 + int(random.below(3));
  const float each = between(2.5, 5.0, random) / float(count);
  for (int i = 0; i < count; ++i) {
    Vector3f at{between(-3.0, 3.0, random), room.height_m - between(0.1, 0.5, random), between(-4.5, 0.5, random)};
    if (!room.open) {
      at.x() = between(room.low.x() + kFromWall_m, room.high.x() - kFromWall_m, random);
      at.z() = between(room.low.y() + kFromWall_m, room.high.y() - kFromWall_m, random);
      at = room.world_from_room * at;
    }
    scene.lights.push_back({at, each * between(0.7, 1.3, random)});
  }
}

Rgb draw_sky(const RoomShape& room, Random& random) {
  const bool day = !room.open && chance(0.7, random);
  const float light = day ? between(0.7, 1.0, random) : between(0.02, 0.2, random);
  const float haze = between(0.8, 1.0, random);
  const auto level = [&](float share) { return static_cast<std::uint8_t>(255.F * light * share); };
  return {level(haze), level(0.5F * (1.F + haze)), level(1.F)};
}

void darken_furniture(float share, Scene& scene, Random& random) {
  constexpr std::size_t kRoom = 0;
  for (std::size_t i = kRoom + 1; i < scene.meshes.size(); ++i) {
    SceneMesh& mesh = scene.meshes[i];
    if (mesh.person >= 0 || !chance(share, random)) continue;
    const auto factor = float(std::exp(random.uniform(std::log(0.015), std::log(0.15))));
    for (Material& material : mesh.materials) material.infrared *= factor;
  }
}

}  // namespace vesalius::synth
