#include "synth/scene/build_scene.h"

#include <fmt/format.h>

#include "synth/scene/people_group.h"
#include "synth/scene/person_plan.h"
#include "synth/scene/place_people.h"
#include "synth/scene/surroundings.h"
#include "vesalius/error.h"

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
      person.mesh = int(built.scene.meshes.size());
      const PersonPlan& plan = plans[member.plan];
      SceneMesh mesh = person_mesh(plan, person.body, built.view, detail_px);
      mesh.person = int(built.people.size());
      built.scene.meshes.push_back(std::move(mesh));
      built.people.push_back(std::move(person));
    }
    for (Furniture& piece : group.furniture) {
      move(piece, placed.world_from_group);
      built.scene.meshes.push_back(std::move(piece.mesh));
    }
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
                       const std::vector<PersonPlan>& plans, Random random) {
  check_arguments(options, placement, intrinsics, plans);
  std::vector<PeopleGroup> groups = make_groups(options, plans, random);
  Stage stage = place_people(options, placement, intrinsics, plans, groups, random);
  const PlacedGroup* first = stage.groups.empty() ? nullptr : stage.groups.data();
  const RoomShape room = draw_room(
      options, first, [&](const Isometry3f& room_from_world) { return extent_of(stage, groups, room_from_world); },
      random);
  stage.occupancy.set_room(room);

  BuiltScene built;
  built.view = {intrinsics, stage.camera.world_from_camera().inverse()};
  built.scene.meshes.push_back(make_room(room, random));
  add_people(plans, options.detail_px, groups, stage, built);
  std::vector<Vector3f> people;
  for (const PlacedPerson& person : built.people) people.push_back(person.body.joints[index(Bone::chest)]);
  const Vector3f eye(0.F, stage.camera.height_m, 0.F);
  furnish(options, room, people, eye, stage.occupancy, built.scene, random);
  built.room = room;
  built.solids = stage.occupancy.solids();
  return built;
}

}  // namespace vesalius::synth
