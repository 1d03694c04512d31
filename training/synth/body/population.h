#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "vesalius/base/options.h"
#include "vesalius/base/random.h"

namespace vesalius::synth {

/// Whose bodies are made.
struct Population {
  float men = 0.5F;           ///< share of men and boys
  float children = 0.2F;      ///< share of people below 18
  float old = 0.2F;           ///< share of people above 60, as far as children leave room
  float age_min_years = 4.F;  ///< people of other ages are left out
  float age_max_years = 90.F;
  float stature_min_m = 0.9F;  ///< people of other statures are left out
  float stature_max_m = 2.2F;
  float build = 0.F;  ///< -1: most are thin, 0: as people are, 1: most are heavy
};

void visit_options(const std::string& prefix, Population& options, OptionVisitor& visitor);

/// Throws UsageError if a minimum is above its maximum.
void check(const Population& population);

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

/// The appearance of a MakeHuman body. Values outside their range are clamped.
struct MakeHumanFactors {
  float gender = 0.5F;       ///< 0 is a woman, 1 a man
  float age_years = 30.F;    ///< child at 10, young at 25, old at 90; younger children are scaled from 10
  float muscle = 0.5F;       ///< 0-1
  float weight = 0.5F;       ///< 0 is thin, 1 heavy
  float height = 0.5F;       ///< 0-1, from short to long limbs for the age
  float proportions = 0.5F;  ///< 0-1; above 0.5 towards ideal proportions
  float african = 1.F / 3.F, asian = 1.F / 3.F, caucasian = 1.F / 3.F;  ///< shares; any sum above 0
  float stature_m = 0.F;  ///< stature to which the body is scaled; 0 leaves it as it is
};

/// Draws a person of a population: age 5 to 85, stature within 2.5 standard deviations of its age and sex.
MakeHumanFactors sample_factors(const Population& population, Random& random);

/// The values of all words that make up the names of targets: "female", "child", "maxmuscle", "asian", ...
inline constexpr std::size_t kFactorWords = 19;
using FactorValues = std::array<float, kFactorWords>;
FactorValues factor_values(const MakeHumanFactors& factors);

/// Returns the words of a target's file name, such as "female-child-minmuscle-averageweight-maxheight.target", as
/// indices of FactorValues. The target's weight is the product of their values. Throws Error for a name with an unknown
/// word.
std::vector<std::uint8_t> factors_of_name(const std::string& path);

}  // namespace vesalius::synth
