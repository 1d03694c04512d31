#pragma once

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <string>

namespace vesalius {

/// Rounds to a tenth of a millimetre where the unit is a metre: no sensor knows more.
inline double rounded(double value, double steps = 1e4) { return std::round(value * steps) / steps; }

/// Returns the double with the shortest text of the float, not the double nearest to it: 0.3, not 0.30000001192092896.
inline double shortest(float value) {
  double exact = 0.0;
  const std::string text = fmt::format("{}", value);
  std::from_chars(text.data(), text.data() + text.size(), exact);
  return exact;
}

}  // namespace vesalius
