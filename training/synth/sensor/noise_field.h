#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "vesalius/base/random.h"

namespace vesalius::synth {

/// Standard normal noise within 3.5 sigma (kurtosis 2.7) from the four bytes of one random number: the price of one
/// draw.
inline float quick_normal(Random& random) {
  const std::uint32_t bits = random.next();
  const auto sum = int((bits & 0xFFU) + ((bits >> 8U) & 0xFFU) + ((bits >> 16U) & 0xFFU) + (bits >> 24U));
  constexpr float kSigma = 147.8F;  // sqrt(4 (256^2 - 1) / 12)
  return float(sum - 510) / kSigma;
}

/// Standard normal noise over a picture with correlated neighbours: cubic B-splines over a lattice of normal numbers,
/// scaled such that the variance is 1 in every pixel. The correlation of two values is about 1/2 at a distance of half
/// a window and 1/20 at a whole window.
class NoiseField {
 public:
  /// `window_px` must be at least 1.
  NoiseField(int width, int height, float window_px, Random& random);
  /// Makes another field of the same size and window.
  NoiseField(const NoiseField& like, Random& random);

  float at(int u, int v) const;
  /// Returns the values of row v, padded as noise_kernel.h requires.
  const Eigen::ArrayXf& row(int v);

 private:
  struct Tap {  ///< the lattice values and weights for a column or row of pixels
    std::size_t first;
    float weight[4];
  };
  static std::vector<Tap> taps(int count, float spacing);
  void draw(Random& random);

  std::vector<Tap> columns_, rows_;
  std::size_t lattice_width_;
  std::vector<float> lattice_;
  Eigen::ArrayXf lattice_row_, row_;  ///< scratch of row()
};

}  // namespace vesalius::synth
