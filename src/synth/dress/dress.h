#pragma once

#include "synth/body/body_mesh.h"
#include "synth/dress/outfit.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// Returns the body with clothes and hair on and things in its hands. Clothes move the skin outwards and keep its
/// labels; skirts, coats, hats and long hair are surfaces of their own, labelled as the part beneath; bags and things
/// held belong to nobody (kBackground). `mesh` is bare: throws Error for one that has been dressed already. `random`
/// decides the folds and sizes.
BodyMesh dress(const BodyMesh& mesh, const Outfit& outfit, const BodyModel& body, Random& random);

}  // namespace vesalius::synth
