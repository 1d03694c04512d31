#pragma once

#include "synth/body/makehuman.h"

namespace vesalius::synth {

/// Returns bodies that need no files: MakeHuman's with a sixth of its vertices, of the mean of all peoples, muscles and
/// limbs' lengths, so that gender, age, weight and stature alone change them. tools/make_builtin_body.py makes them.
/// Left and right are exact mirror images.
const MakeHumanModel& builtin_bodies();

/// Returns one of them, as make_body() does.
BodyMesh make_builtin_body(const MakeHumanFactors& factors, const BodyModel& body);

}  // namespace vesalius::synth
