#pragma once

#include <vector>

#include "synth/scene/camera_pose.h"
#include "synth/scene/occupancy.h"
#include "synth/scene/people_group.h"

namespace vesalius::synth {

/// The place of a group of people.
struct PlacedGroup {
  int group = 0;  ///< index
  Eigen::Isometry3f world_from_group = Eigen::Isometry3f::Identity();
};

/// Camera and people, before the room is built around them.
struct Stage {
  CameraPose camera;
  std::vector<PlacedGroup> groups;
  Occupancy occupancy;  ///< these people with their seats and beds
};

/// Places a camera and puts the groups into its view, apart from each other. Groups that find no place are left out.
Stage place_people(const SceneOptions& options, const CameraPlacement& placement, const Camera& intrinsics,
                   const std::vector<PersonPlan>& plans, const std::vector<PeopleGroup>& groups, Random& random);

}  // namespace vesalius::synth
