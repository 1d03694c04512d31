#include "vesalius/base/capsule.h"

#include <cmath>
#include <limits>
#include <utility>

namespace vesalius {

Box box_around(const Capsule& capsule, const Camera& camera) {
  constexpr float kNearest_m = 0.1F;
  constexpr float kFar = std::numeric_limits<float>::infinity();
  float left = kFar, right = -kFar, top = kFar, bottom = -kFar;
  for (const auto& [centre, radius] :
       {std::pair{capsule.from, capsule.from_radius}, std::pair{capsule.to, capsule.to_radius}}) {
    const float nearest = std::max(kNearest_m, centre.z() - radius), z = std::max(kNearest_m, centre.z());
    const float x = centre.x() / z, y = centre.y() / z;
    const float ru = camera.fx * radius / nearest * (1.F + std::abs(x)),
                rv = camera.fy * radius / nearest * (1.F + std::abs(y));
    const float u = camera.cx + camera.fx * x, v = camera.cy + camera.fy * y;
    left = std::min(left, u - ru);
    right = std::max(right, u + ru);
    top = std::min(top, v - rv);
    bottom = std::max(bottom, v + rv);
  }
  const auto inside = [](float at, int size) { return int(std::clamp(at, 0.F, float(size))); };
  Box box;
  box.u = inside(left, camera.width);
  box.v = inside(top, camera.height);
  box.width = inside(right + 1.F, camera.width) - box.u;
  box.height = inside(bottom + 1.F, camera.height) - box.v;
  return box;
}

}  // namespace vesalius
