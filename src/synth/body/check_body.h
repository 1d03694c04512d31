#pragma once

#include "synth/body/body_mesh.h"

namespace vesalius::synth {

/// Throws Error naming what is wrong with a body: an index out of range, weights that do not sum to 1, a number that is
/// not finite.
void check(const BodyMesh& mesh, const BodyModel& body);

}  // namespace vesalius::synth
