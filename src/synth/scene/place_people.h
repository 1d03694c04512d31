#pragma once

#include <vector>

#include "synth/scene/camera_pose.h"
#include "synth/scene/occupancy.h"
#include "synth/scene/people_group.h"

namespace vesalius::synth {

/// Where a group of people has been put.
struct PlacedGroup {
  int group = 0;  ///< index
  Eigen::Isometry3f world_from_group = Eigen::Isometry3f::Identity();
};

/// Camera and people before the room is built about them.
struct Stage {
  CameraPose camera;
  std::vector<PlacedGroup> groups;
  Occupancy occupancy;  ///< of those people and what holds them up
};

/// Holds a camera and puts the groups into its view, apart from each other. Groups that find no place are left out.
Stage place_people(const SceneOptions& options, const CameraPlacement& placement, const Camera& intrinsics,
                   const std::vector<PersonPlan>& plans, const std::vector<PeopleGroup>& groups, Random& random);

}  // namespace vesalius::synth
