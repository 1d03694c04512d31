#pragma once

#include "vesalius/base/random.h"

namespace vesalius::synth {

/// What the built-in body looks like.
struct BuiltinShape {
  float stature_m = 1.7F;  ///< 0.9 to 2.2
  float maleness = 0.5F;   ///< 0 woman, 1 man
  float build = 0.F;       ///< -1 thin, 1 heavy
  float age_years = 30.F;  ///< 4 to 90; proportions of children below 18
};

/// Returns a person at random: age 4 to 85, stature within 2.5 standard deviations of its age and sex.
BuiltinShape sample_builtin_shape(Random& random);

}  // namespace vesalius::synth
