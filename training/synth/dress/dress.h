#pragma once

#include "synth/body/body_mesh.h"
#include "synth/dress/outfit.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// Returns the body with clothes, hair and carried things. Clothes move the skin outwards and keep its labels. Skirts,
/// coats, hats and long hair are surfaces of their own with the label of the part beneath; bags and held things belong
/// to nobody (kBackground). `random` decides folds and sizes. Throws Error if `mesh` is already dressed.
BodyMesh dress(const BodyMesh& mesh, const Outfit& outfit, const BodyModel& body, Random& random);

}  // namespace vesalius::synth
