#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "vesalius/base/random.h"

namespace vesalius::synth {

/// What a MakeHuman body looks like. Values outside their range are taken as the nearest within.
struct MakeHumanFactors {
  float gender = 0.5F;       ///< 0 woman, 1 man
  float age_years = 30.F;    ///< 10 child, 25 young, 90 old; younger children are small ones of 10
  float muscle = 0.5F;       ///< 0-1
  float weight = 0.5F;       ///< 0 thin, 1 heavy
  float height = 0.5F;       ///< 0-1: short to long limbs for the age
  float proportions = 0.5F;  ///< 0-1: towards ideal above 0.5
  float african = 1.F / 3.F, asian = 1.F / 3.F, caucasian = 1.F / 3.F;  ///< shares; any sum above 0
  float stature_m = 0.F;  ///< height the body is scaled to; 0: as the factors make it
};

/// Returns a person at random: age 5 to 85, stature within 2.5 standard deviations of its age and sex.
MakeHumanFactors sample_factors(Random& random);

/// The strength of every word that names of targets are made of: "female", "child", "maxmuscle", "asian", ...
inline constexpr std::size_t kFactorWords = 19;
using FactorValues = std::array<float, kFactorWords>;
FactorValues factor_values(const MakeHumanFactors& factors);

/// Returns the words of a target's file name, "female-child-minmuscle-averageweight-maxheight.target", as indices of
/// FactorValues; its weight is the product of their values. Throws Error for a name with another word.
std::vector<std::uint8_t> factors_of_name(const std::string& path);

}  // namespace vesalius::synth
