#pragma once

#include <vector>

#include "synth/body/poser.h"
#include "synth/mesh/oriented_box.h"
#include "synth/scene/camera_pose.h"
#include "synth/scene/person_plan.h"
#include "synth/scene/room.h"
#include "synth/scene/scene.h"
#include "synth/scene/scene_options.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

struct PlacedPerson {
  PosedBody body;  ///< body in world coordinates
  Eigen::Isometry3f world_from_body = Eigen::Isometry3f::Identity();
  int mesh = 0;  ///< index in scene.meshes
  int plan = 0;  ///< index of the person's plan
  Posture posture = Posture::standing;
};

struct BuiltScene {
  Scene scene;
  View view;
  std::vector<PlacedPerson> people;  ///< people; person i has index i in the images
  RoomShape room;
  std::vector<OrientedBox> solids;  ///< furniture as boxes that were kept apart from people
};

/// Puts the people of the plans into a room in front of a camera. They stand or kneel on the floor, sit on seats that
/// are made to fit, or lie on beds, sofas or the floor. Furniture stands around them, and some things in front of them.
/// Nobody is inside furniture, walls or other people by more than 3 cm. People who find no place after a bounded number
/// of tries are left out. The same
/// arguments give the same scene. Throws UsageError for invalid options.
BuiltScene build_scene(const SceneOptions& options, const CameraPlacement& placement, const Camera& intrinsics,
                       const std::vector<PersonPlan>& plans, Random random);

}  // namespace vesalius::synth
