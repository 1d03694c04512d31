#pragma once

#include "synth/body/body_mesh.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// What the built-in body looks like.
struct BuiltinShape {
  float stature_m = 1.7F;  ///< 0.9 to 2.2
  float maleness = 0.5F;   ///< 0 woman, 1 man
  float build = 0.F;       ///< -1 thin, 1 heavy
  float age_years = 30.F;  ///< 4 to 90; proportions of children below 18
};

/// A person at random: age 4 to 85, stature within 2.5 standard deviations of its age and sex.
BuiltinShape sample_builtin_shape(Random& random);

/// A smooth parametric body of our own that needs no files, labelled by the surface rules of `body`, about 14,000
/// triangles, its feet on y = 0. Left and right mirror each other to the last bit. Values outside their range are taken
/// as the nearest within. Lengths follow Drillis and Contini (1966) as quoted by Winter (Biomechanics and Motor Control
/// of Human Movement, fig. 4.1), girths ANSUR II (2012).
BodyMesh make_builtin_body(const BuiltinShape& shape, const BodyModel& body);

}  // namespace vesalius::synth
