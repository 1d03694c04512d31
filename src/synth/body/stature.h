#pragma once

namespace vesalius::synth {

/// Heights of people, metres.
struct Stature {
  float mean_m = 0.F;
  float sigma_m = 0.F;  ///< between people of that age and sex
};

/// Mean and spread by age (4 to 90 years, clamped) and sex (0 woman, 1 man, between: mixed).
/// Children and youths: CDC growth charts (2000), 50th percentile; adults: ANSUR II (2012), 1.629 m +- 0.064 and
/// 1.756 m +- 0.069; old people lose about 4 cm (men) and 6 cm (women) from 40 to 80 (Sorkin et al. 1999).
Stature stature_at(float age_years, float maleness);

}  // namespace vesalius::synth
