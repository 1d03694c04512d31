#pragma once

#include "synth/scene/person_plan.h"
#include "synth/scene/scene.h"

namespace vesalius::synth {

/// Returns the surface of a posed body in the world, as coarse as `detail_px` pixels of the view allow at the body's
/// nearest point.
SceneMesh person_mesh(const PersonPlan& plan, const PosedBody& body, const View& view, float detail_px);

/// Returns the body after a motion, for example into the world.
PosedBody moved(PosedBody body, const Eigen::Isometry3f& motion);

}  // namespace vesalius::synth
