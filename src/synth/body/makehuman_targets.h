#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "synth/body/makehuman.h"

namespace vesalius::synth {

/// Strength of every word that names of targets are made of: "female", "child", "maxmuscle", "asian", ...
inline constexpr std::size_t kFactorWords = 19;
using FactorValues = std::array<float, kFactorWords>;
FactorValues factor_values(const MakeHumanFactors& factors);

/// Words of a target's file name, "female-child-minmuscle-averageweight-maxheight.target", as indices of FactorValues;
/// its weight is the product of their values. Throws Error for a name with another word.
std::vector<std::uint8_t> factors_of_name(const std::string& path);

}  // namespace vesalius::synth
