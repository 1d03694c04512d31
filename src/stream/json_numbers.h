#pragma once

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string>

namespace vesalius {

inline constexpr double kDegrees = 180.0 / std::numbers::pi;  ///< degrees of a radian

/// Rounds to a tenth of a millimetre where the unit is a metre: no sensor knows more. What was read from a text with so
/// many digits as a float becomes the double nearest to the text.
inline double rounded(double value, double steps = 1e4) { return std::round(value * steps) / steps; }
inline Eigen::Vector3d rounded(const Eigen::Vector3f& v) { return {rounded(v.x()), rounded(v.y()), rounded(v.z())}; }
inline Eigen::Quaterniond rounded(const Eigen::Quaternionf& q) {
  return {rounded(q.w()), rounded(q.x()), rounded(q.y()), rounded(q.z())};
}

/// Returns the double with the shortest text of the float, not the double nearest to it: 0.3, not 0.30000001192092896.
inline double shortest(float value) {
  double exact = 0.0;
  const std::string text = fmt::format("{}", value);
  std::from_chars(text.data(), text.data() + text.size(), exact);
  return exact;
}

}  // namespace vesalius
