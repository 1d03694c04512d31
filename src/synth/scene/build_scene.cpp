#include "synth/scene/build_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "synth/scene/furnish.h"
#include "synth/scene/palette.h"
#include "synth/scene/people_group.h"
#include "synth/scene/place_people.h"
#include "synth/scene/room.h"
#include "vesalius/base/error.h"

namespace vesalius::synth {
namespace {

using Eigen::Isometry3f;
using Eigen::Vector3f;

/// Returns an upright box in the room's frame that contains the camera, and people with their seats and beds.
Eigen::AlignedBox3f extent_of(const Stage& stage, const std::vector<PeopleGroup>& groups,
                              const Isometry3f& room_from_world) {
  constexpr float kEyeClear_m = 0.12F;
  Eigen::AlignedBox3f extent;
  const Vector3f eye = room_from_world * Vector3f(0.F, stage.camera.height_m, 0.F);
  extent.extend(eye + Vector3f::Constant(kEyeClear_m));
  extent.extend(eye - Vector3f::Constant(kEyeClear_m));
  for (const PlacedGroup& placed : stage.groups) {
    const PeopleGroup& group = groups[placed.group];
    const Isometry3f room_from_group = room_from_world * placed.world_from_group;
    for (const GroupMember& member : group.members) {
      const Isometry3f room_from_body = room_from_group * member.group_from_body;
      for (const Vector3f& p : member.body.vertices) extent.extend(room_from_body * p);
    }
    for (const Furniture& piece : group.furniture) {
      for (const Vector3f& p : piece.mesh.vertices) extent.extend(room_from_group * p);
    }
  }
  return extent;
}

/// Draws the room around everything that is placed, with some walls near and some far.
RoomShape draw_room(const SceneOptions& options, const Stage& stage, const std::vector<PeopleGroup>& groups,
                    Random& random) {
  constexpr float kWallGap_m = 0.02F, kSmallest_m = 1.8F;
  RoomShape room;
  room.open = chance(options.open_share, random);
  float yaw = between(-std::numbers::pi / 4, std::numbers::pi / 4, random);
  if (!stage.groups.empty() && chance(0.5, random)) {  // furniture in use often stands parallel to the walls
    const Vector3f front = stage.groups[0].world_from_group.linear().col(2);
    yaw = std::atan2(front.x(), front.z());
  }
  room.world_from_room = Isometry3f(Eigen::AngleAxisf(yaw, Vector3f::UnitY()));
  const bool wall_behind = !stage.groups.empty() && asked(options.wall_probability, random);
  if (wall_behind) {  // the room's back wall is where the camera sees the first people
    room.open = false;
    const Vector3f at = stage.groups[0].world_from_group.translation();
    room.world_from_room =
        Isometry3f(Eigen::AngleAxisf(std::atan2(-at.x(), -at.z()) + between(-0.4, 0.4, random), Vector3f::UnitY()));
  }
  const Isometry3f room_from_world = room.world_from_room.inverse();
  Eigen::AlignedBox3f extent = extent_of(stage, groups, room_from_world);
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

/// Adds lamps below the ceiling and ambient light.
void add_lights(const RoomShape& room, Scene& scene, Random& random) {
  constexpr float kFromWall_m = 0.5F;
  scene.ambient = between(0.3, 0.6, random);
  const int count = 1 + static_cast<int>(random.below(3));
  const float each = between(2.5, 5.0, random) / static_cast<float>(count);
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

/// Returns the allowed error of a person's surface: `detail_px` pixels at their point nearest to the camera.
float tolerance_m(const View& view, const PosedBody& body, float detail_px) {
  constexpr float kFlesh_m = 0.3F;  // the skin is nearer to the camera than the bones
  float nearest_m = std::numeric_limits<float>::max();
  for (const auto* points : {&body.joints, &body.ends}) {
    for (const Vector3f& p : *points) nearest_m = std::min(nearest_m, (view.camera_from_world * p).z());
  }
  return detail_px * std::max(0.F, nearest_m - kFlesh_m) / std::max(view.camera.fx, view.camera.fy);
}

/// Draws the colour outside: more often day than night, and dim beyond a hall's edge.
Rgb draw_sky(const RoomShape& room, Random& random) {
  const bool day = !room.open && chance(0.7, random);
  const float light = day ? between(0.7, 1.0, random) : between(0.02, 0.2, random);
  const float haze = between(0.8, 1.0, random);
  const auto level = [&](float share) { return static_cast<std::uint8_t>(255.F * light * share); };
  return {level(haze), level(0.5F * (1.F + haze)), level(1.F)};
}

SceneMesh person_mesh(const PersonPlan& plan, const PosedBody& body, const CoarseSurface* coarse) {
  const BodyTopology& topology = *plan.poser->mesh().topology;
  SceneMesh mesh;
  mesh.materials.assign(plan.look.begin(), plan.look.end());
  if (coarse != nullptr) {
    mesh.vertices.reserve(coarse->vertex.size());
    for (const std::uint32_t v : coarse->vertex) mesh.vertices.push_back(body.vertices[v]);
    mesh.triangles = coarse->triangles;
    mesh.part = coarse->part;
    mesh.material = coarse->fabric;
    return mesh;
  }
  mesh.vertices = body.vertices;
  mesh.triangles = topology.triangles;
  mesh.part = topology.part;
  mesh.material.reserve(topology.fabric.size());
  for (const Fabric fabric : topology.fabric) mesh.material.push_back(static_cast<std::uint8_t>(fabric));
  return mesh;
}

PosedBody moved(PosedBody body, const Isometry3f& motion) {
  for (auto* points : {&body.vertices, &body.parts}) {
    for (Vector3f& p : *points) p = motion * p;
  }
  for (auto* points : {&body.joints, &body.ends}) {
    for (Vector3f& p : *points) p = motion * p;
  }
  return body;
}

void add_people(const std::vector<PersonPlan>& plans, float detail_px, std::vector<PeopleGroup>& groups,
                const Stage& stage, BuiltScene& built) {
  for (const PlacedGroup& placed : stage.groups) {
    PeopleGroup& group = groups[placed.group];
    for (GroupMember& member : group.members) {
      PlacedPerson person;
      person.world_from_body = placed.world_from_group * member.group_from_body;
      person.body = moved(std::move(member.body), person.world_from_body);
      person.plan = member.plan;
      person.posture = plans[member.plan].posture;
      person.mesh = static_cast<int>(built.scene.meshes.size());
      const PersonPlan& plan = plans[member.plan];
      const float tolerance = tolerance_m(built.view, person.body, detail_px);
      SceneMesh mesh =
          person_mesh(plan, person.body, plan.detail != nullptr ? plan.detail->within(tolerance) : nullptr);
      mesh.person = static_cast<int>(built.people.size());
      built.scene.meshes.push_back(std::move(mesh));
      built.people.push_back(std::move(person));
    }
    for (Furniture& piece : group.furniture) {
      move(piece, placed.world_from_group);
      built.scene.meshes.push_back(std::move(piece.mesh));
    }
  }
}

/// Makes whole pieces black leather or lacquer, of which depth cameras see only blotches or nothing.
void darken_furniture(float share, Scene& scene, Random& random) {
  constexpr std::size_t kRoom = 0;
  for (std::size_t i = kRoom + 1; i < scene.meshes.size(); ++i) {
    SceneMesh& mesh = scene.meshes[i];
    if (mesh.person >= 0 || !chance(share, random)) continue;
    const auto factor = static_cast<float>(std::exp(random.uniform(std::log(0.015), std::log(0.15))));
    for (Material& material : mesh.materials) material.infrared *= factor;
  }
}

void check_arguments(const SceneOptions& options, const CameraPlacement& placement, const Camera& intrinsics,
                     const std::vector<PersonPlan>& plans) {
  check(options);
  check(placement);
  vesalius::check(intrinsics);
  if (plans.size() >= kBackground) throw Error(fmt::format("{} people in a scene, at most 254", plans.size()));
  for (std::size_t i = 0; i < plans.size(); ++i) {
    if (plans[i].poser == nullptr) throw Error(fmt::format("person {} of a scene has no body", i));
  }
}

}  // namespace

BuiltScene build_scene(const SceneOptions& options, const CameraPlacement& placement, const Camera& intrinsics,
                       const std::vector<PersonPlan>& plans, const std::vector<SceneMesh>& models, Random random) {
  check_arguments(options, placement, intrinsics, plans);
  std::vector<PeopleGroup> groups = make_groups(options, plans, random);
  Stage stage = place_people(options, placement, intrinsics, plans, groups, random);
  const RoomShape room = draw_room(options, stage, groups, random);
  stage.occupancy.set_room(room);

  BuiltScene built;
  built.view = {intrinsics, stage.camera.world_from_camera().inverse()};
  built.scene.meshes.push_back(make_room(room, random));
  add_people(plans, options.detail_px, groups, stage, built);
  std::vector<Vector3f> people;
  for (const PlacedPerson& person : built.people) people.push_back(person.body.joints[index(Bone::chest)]);
  const Vector3f eye(0.F, stage.camera.height_m, 0.F);
  for (Furniture& piece : furnish(options, room, models, people, eye, stage.occupancy, random)) {
    built.scene.meshes.push_back(std::move(piece.mesh));
  }
  add_lights(room, built.scene, random);
  built.scene.sky = draw_sky(room, random);
  darken_furniture(options.dark_furniture, built.scene, random);
  built.room = room;
  built.solids = stage.occupancy.solids();
  return built;
}

}  // namespace vesalius::synth
