#pragma once

#include <vector>

#include "synth/furniture/furniture.h"
#include "synth/scene/occupancy.h"
#include "synth/scene/person_plan.h"
#include "synth/scene/scene_options.h"
#include "vesalius/base/random.h"

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

/// Poses the people of the plans and gives those who sit or lie something that fits. Some share a sofa, some stand side
/// by side. People who find no seat are left out.
std::vector<PeopleGroup> make_groups(const SceneOptions& options, const std::vector<PersonPlan>& plans, Random& random);

}  // namespace vesalius::synth
