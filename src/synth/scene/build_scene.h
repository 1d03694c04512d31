#pragma once

#include <array>
#include <optional>
#include <vector>

#include "synth/body/body_detail.h"
#include "synth/body/body_mesh.h"
#include "synth/scene/camera_pose.h"
#include "synth/scene/oriented_box.h"
#include "synth/scene/room.h"
#include "synth/scene/scene.h"
#include "vesalius/base/options.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// What rooms are like and how people are put into them.
struct SceneOptions {
  float open_share = 0.12F;  ///< of scenes that are a hall whose walls are out of sight
  int furniture_min = 0;     ///< pieces beside those that people sit and lie on
  int furniture_max = 10;
  float mannequin_share = 0.1F;       ///< of those pieces that resemble people
  float occluder_probability = 0.3F;  ///< something stands between the camera and a person
  float near_probability = 0.15F;     ///< something large stands close to the camera
  float table_probability = 0.35F;    ///< a table stands in front of a sitting person
  float sofa_probability = 0.4F;      ///< two sitting people share a sofa
  float beside_probability = 0.F;     ///< two standing people stand shoulder to shoulder
  float bed_probability = 0.6F;       ///< a lying person has a bed or sofa rather than the floor
  float frontal_share = 0.45F;  ///< of people who face the camera within `frontal_range_deg`; others face anywhere
  float frontal_range_deg = 60.F;
  float dark_furniture = 0.1F;  ///< of all pieces: send back next to no infrared light
  float min_visible = 0.3F;     ///< share of a person's bones within the picture
  float detail_px = 0.35F;      ///< how far a coarser surface of somebody far away may stray from the full one; 0: none
};

void visit_options(const std::string& prefix, SceneOptions& options, OptionVisitor& visitor);

/// Throws UsageError naming an option out of its range.
void check(const SceneOptions& options);

/// A person who is to be in the picture.
struct PersonPlan {
  const Poser* poser = nullptr;        ///< must outlive the call
  const BodyDetail* detail = nullptr;  ///< its coarser surfaces, must outlive the call; none: always the full one
  Pose pose;
  Posture posture = Posture::standing;
  std::array<Material, kFabricCount> look;
  /// Heading, 0 = towards the camera, positive = turned to the person's own left; drawn by the options where not given.
  std::optional<float> yaw_rad;
};

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
