#pragma once

#include <Eigen/Core>
#include <cmath>

namespace vesalius::synth {

/// Angle (rad) from its cosine in [0, 1]: Abramowitz and Stegun 4.4.45, error below 7e-5.
inline Eigen::ArrayXf angle_of(const Eigen::ArrayXf& c) {
  return (1.F - c).sqrt() * (1.5707288F + c * (-0.2121144F + c * (0.0742610F - 0.0187293F * c)));
}
inline float angle_of(float c) {
  return std::sqrt(1.F - c) * (1.5707288F + c * (-0.2121144F + c * (0.0742610F - 0.0187293F * c)));
}

}  // namespace vesalius::synth
