#pragma once

#include <cmath>
#include <functional>
#include <optional>

#include "io/lens/lens.h"
#include "vesalius/image.h"

namespace vesalius::test {

/// Returns the picture of a camera with a lens, each pixel the value of its ray; `none` where the lens sees nothing.
template <class T>
Image<T> seen_through(const LensCamera& camera, const std::function<T(const Eigen::Vector2d&)>& value, T none = {}) {
  const Camera& c = camera.camera;
  Image<T> picture(c.width, c.height, none);
  for (int v = 0; v < c.height; ++v) {
    for (int u = 0; u < c.width; ++u) {
      const Eigen::Vector3f ray = c.point(static_cast<float>(u), static_cast<float>(v), 1.F);
      if (const auto true_ray = undistort(camera.lens, ray.head<2>().cast<double>())) picture(u, v) = value(*true_ray);
    }
  }
  return picture;
}

}  // namespace vesalius::test
