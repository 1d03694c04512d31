#pragma once

#include "synth/body/body_mesh.h"

namespace vesalius::synth {

/// Throws Error naming the fault if a body has an index out of range, weights that do not sum to 1, or a number that is
/// not finite.
void check(const BodyMesh& mesh, const BodyModel& body);

}  // namespace vesalius::synth
