#pragma once

#include <Eigen/Core>
#include <vector>

#include "vesalius/frame.h"

namespace vesalius {

/// The points of a picture's pixels, as point_at returns them, without divisions for each.
class Rays {
 public:
  explicit Rays(const Camera& camera) {
    for (int u = 0; u < camera.width; ++u) across_.push_back((float(u) - camera.cx) / camera.fx);
    for (int v = 0; v < camera.height; ++v) down_.push_back((float(v) - camera.cy) / camera.fy);
  }

  /// Returns the point of a pixel in metres, optical frame. `depth` is of the camera's size.
  Eigen::Vector3f point(const DepthImage& depth, int u, int v) const {
    const float z = float(depth(u, v)) * 1e-3F;
    return {across_[u] * z, down_[v] * z, z};
  }

 private:
  std::vector<float> across_, down_;  ///< of a point a metre away: x of columns, y of rows
};

}  // namespace vesalius
