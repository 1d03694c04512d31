#pragma once

#include <vector>

#include "synth/scene/group.h"
#include "synth/scene/person_plan.h"
#include "synth/scene/scene_options.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// Poses the people of the plans and gives those who sit or lie something that fits. Some share a sofa, some stand side
/// by side. People who find no seat are left out.
std::vector<PeopleGroup> make_groups(const SceneOptions& options, const std::vector<PersonPlan>& plans, Random& random);

}  // namespace vesalius::synth
