#pragma once

#include "synth/body/population.h"

namespace vesalius::synth {

/// The appearance of the built-in body.
struct BuiltinShape {
  float stature_m = 1.7F;  ///< 0.9 to 2.2
  float maleness = 0.5F;   ///< 0 is a woman, 1 a man
  float build = 0.F;       ///< -1 is thin, 1 heavy
  float age_years = 30.F;  ///< 4 to 90; below 18 the body has a child's proportions
};

/// Draws a person of a population: age 4 to 85, stature within 2.5 standard deviations of its age and sex.
BuiltinShape sample_builtin_shape(const Population& population, Random& random);

}  // namespace vesalius::synth
