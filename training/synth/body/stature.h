#pragma once

namespace vesalius::synth {

/// The distribution of people's heights in metres.
struct Stature {
  float mean_m = 0.F;
  float sigma_m = 0.F;  ///< standard deviation between people of that age and sex
};

/// Returns mean and spread by age (4 to 90 years, clamped) and sex (0 woman, 1 man, mixed between them). The sources
/// are, for children and youths, the 50th percentile of the CDC growth charts (2000), and for adults ANSUR II (2012),
/// 1.629 m +- 0.064 and 1.756 m +- 0.069. Old people lose about 4 cm (men) and 6 cm (women) from 40 to 80 (Sorkin et
/// al. 1999).
Stature stature_at(float age_years, float maleness);

}  // namespace vesalius::synth
