#pragma once

#include <cstddef>
#include <vector>

#include "vesalius/camera.h"

namespace vesalius::synth {

/// The rays (x, y, 1) through the centres of a camera's pixels: Camera::point() at 1 m without its divisions.
class CameraRays {
 public:
  static constexpr int kBeyond = 3;  ///< extra columns and rows beside the picture, for tiles of 4 pixels

  explicit CameraRays(const Camera& camera) {
    x_.reserve(camera.width + kBeyond);
    y_.reserve(camera.height + kBeyond);
    for (int u = 0; u < camera.width + kBeyond; ++u) x_.push_back(camera.point(float(u), 0.F, 1.F).x());
    for (int v = 0; v < camera.height + kBeyond; ++v) y_.push_back(camera.point(0.F, float(v), 1.F).y());
  }

  const float* x() const { return x_.data(); }
  float x(int u) const { return x_[u]; }
  float y(int v) const { return y_[v]; }

 private:
  std::vector<float> x_, y_;
};

}  // namespace vesalius::synth
