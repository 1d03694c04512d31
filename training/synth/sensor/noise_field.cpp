#include "synth/sensor/noise_field.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

#include "synth/sensor/noise_kernel.h"

namespace vesalius::synth {

std::vector<NoiseField::Tap> NoiseField::taps(int count, float spacing) {
  std::vector<Tap> taps(count);
  for (std::size_t i = 0; i < taps.size(); ++i) {
    const float x = float(i) / spacing;
    const float f = x - std::floor(x);
    const float g = 1.F - f;
    Tap& tap = taps[i];
    tap.first = static_cast<std::size_t>(x);
    const float weights[4] = {g * g * g, 3.F * f * f * f - 6.F * f * f + 4.F, 3.F * g * g * g - 6.F * g * g + 4.F,
                              f * f * f};
    float square = 0.F;
    for (const float w : weights) square += w * w;
    const float norm = std::sqrt(square);
    std::transform(weights, weights + 4, tap.weight, [norm](float w) { return w / norm; });
  }
  return taps;
}

NoiseField::NoiseField(int width, int height, float window_px, Random& random)
    : columns_(taps(width, 0.5F * window_px)), rows_(taps(height, 0.5F * window_px)) {
  assert(width > 0 && height > 0 && window_px >= 1.F);
  lattice_width_ = columns_.back().first + 4;
  lattice_.resize(lattice_width_ * (rows_.back().first + 4));
  row_ = Eigen::ArrayXf::Zero(padded_width(width));
  draw(random);
}

NoiseField::NoiseField(const NoiseField& like, Random& random) : NoiseField(like) { draw(random); }

void NoiseField::draw(Random& random) {
  for (float& value : lattice_) value = quick_normal(random);
}

float NoiseField::at(int u, int v) const {
  const Tap& column = columns_[u];
  const Tap& row = rows_[v];
  float sum = 0.F;
  for (std::size_t j = 0; j < 4; ++j) {
    const float* lattice = lattice_.data() + (row.first + j) * lattice_width_ + column.first;
    const float* w = column.weight;
    sum += row.weight[j] * (w[0] * lattice[0] + w[1] * lattice[1] + w[2] * lattice[2] + w[3] * lattice[3]);
  }
  return sum;
}

const Eigen::ArrayXf& NoiseField::row(int v) {
  const Tap& tap = rows_[v];
  const auto count = static_cast<Eigen::Index>(lattice_width_);
  const auto lattice = [&](std::size_t j) {
    return Eigen::Map<const Eigen::ArrayXf>(lattice_.data() + (tap.first + j) * lattice_width_, count);
  };
  lattice_row_ =
      tap.weight[0] * lattice(0) + tap.weight[1] * lattice(1) + tap.weight[2] * lattice(2) + tap.weight[3] * lattice(3);
  float* out = row_.data();
  for (const Tap& column : columns_) {
    const float* in = lattice_row_.data() + column.first;
    const float* w = column.weight;
    *out++ = w[0] * in[0] + w[1] * in[1] + w[2] * in[2] + w[3] * in[3];
  }
  return row_;
}

}  // namespace vesalius::synth
