#include "vesalius/camera.h"

#include <cmath>

#include "vesalius/error.h"

namespace vesalius {

Camera Camera::resized(int new_width, int new_height) const {
  const float sx = float(new_width) / float(width);
  const float sy = float(new_height) / float(height);
  // Pixel centres are integers, so the picture spans [-0.5, width - 0.5].
  return {new_width, new_height, fx * sx, fy * sy, (cx + 0.5F) * sx - 0.5F, (cy + 0.5F) * sy - 0.5F};
}

void check(const Camera& camera) {
  if (camera.width <= 0 || camera.height <= 0) {
    throw Error("camera: picture size " + std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                ", expected at least 1x1");
  }
  const auto usable = [](float f) { return std::isfinite(f) && f > 0.F; };
  if (!usable(camera.fx) || !usable(camera.fy)) {
    throw Error("camera: focal length fx=" + std::to_string(camera.fx) + " fy=" + std::to_string(camera.fy) +
                ", expected positive numbers of pixels");
  }
  if (!std::isfinite(camera.cx) || !std::isfinite(camera.cy)) {
    throw Error("camera: principal point is not finite");
  }
}

}  // namespace vesalius
