#pragma once

#include <vector>

#include "synth/furniture/furniture.h"
#include "synth/scene/occupancy.h"

namespace vesalius::synth {

/// A posed person within a group.
struct GroupMember {
  int plan = 0;
  PosedBody body;  ///< in the body's own frame
  Eigen::Isometry3f group_from_body = Eigen::Isometry3f::Identity();
  BodyOutline outline;  ///< outline in the group's frame
};

/// People with their seats or beds, to be placed in the room together. In the group's frame, in metres, y points up,
/// the floor is y = 0 and the people face about +z.
struct PeopleGroup {
  std::vector<GroupMember> members;
  std::vector<Furniture> furniture;
};

}  // namespace vesalius::synth
