#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "synth/body/population.h"

namespace vesalius::synth {

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
