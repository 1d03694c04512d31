#pragma once

#include <vector>

#include "synth/body/poser.h"
#include "synth/scene/camera_pose.h"
#include "synth/scene/oriented_box.h"
#include "synth/scene/person_plan.h"
#include "synth/scene/room.h"
#include "synth/scene/scene.h"
#include "synth/scene/scene_options.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

struct PlacedPerson {
  PosedBody body;  ///< all in world coordinates
  Eigen::Isometry3f world_from_body = Eigen::Isometry3f::Identity();
  int mesh = 0;  ///< index in scene.meshes
  int plan = 0;  ///< index of the plan
};

struct BuiltScene {
  Scene scene;
  View view;
  std::vector<PlacedPerson> people;  ///< person i has index i in the images
  RoomShape room;
  std::vector<OrientedBox> solids;  ///< furniture as it was kept apart from people
};

/// Puts the people of the plans into a room in front of a camera: standing and kneeling on the floor, sitting on seats
/// made to fit, lying on beds, sofas or the floor; furniture around them, things in front of them. Nobody is inside
/// furniture, walls or others by more than 3 cm. Who finds no place after a bounded number of tries is left out.
/// `models` are pieces of furniture of the user's, standing on y = 0 about the origin. Same arguments, same scene.
/// Throws UsageError for options that cannot be meant.
BuiltScene build_scene(const SceneOptions& options, const CameraPlacement& placement, const Camera& intrinsics,
                       const std::vector<PersonPlan>& plans, const std::vector<SceneMesh>& models, Random random);

}  // namespace vesalius::synth
