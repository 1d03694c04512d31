#include "vesalius/base/rays.h"

#include <gtest/gtest.h>

#include "vesalius/base/random.h"

namespace vesalius {
namespace {

TEST(Rays, GiveThePointsOfAllPixels) {
  Random random(8);
  const Camera camera{33, 21, 28.3F, 29.1F, 15.7F, 11.2F};
  DepthImage depth(camera.width, camera.height);
  for (std::uint16_t& mm : depth) mm = static_cast<std::uint16_t>(random.below(65536));
  const Rays rays(camera);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      EXPECT_EQ(rays.point(depth, u, v), point_at(camera, depth, u, v)) << u << ' ' << v;
    }
  }
}

}  // namespace
}  // namespace vesalius
